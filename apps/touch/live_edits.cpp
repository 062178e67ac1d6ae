// SPDX-License-Identifier: Apache-2.0
#include "apps/touch/live_edits.hpp"

#include <algorithm>
#include <iterator>

#include <fmt/format.h>

#include "apps/console/message.hpp"
#include "base/atomic_file.hpp"
#include "base/error.hpp"
#include "engine/edit/lower_edit.hpp"
#include "engine/files/volume_file.hpp"
#include "engine/journal/acknowledged_file.hpp"
#include "engine/journal/volume_identity.hpp"
#include "servo/algorithms/registry.hpp"

namespace palpate {
namespace {

constexpr std::size_t kHistoryBytes = 0;  // a scripted run undoes nothing

// The brush somewhere in the volume, to find out what is wrong with it before the run.
void checkBrush(const EditCommand& brush, const std::string& text, const Volume& volume, const BrushProfile& profile) {
  EditCommand command = brush;
  command.from_W = command.to_W = volume.lattice().toWorld((volume.size() / 2).cast<double>());
  try {
    (void)lowerEdits(std::span(&command, 1), volume.size(), volume.lattice(), profile);
  } catch (const Error& error) {
    throw Error(error.code(), "--edit " + text, error.reason(), error.remedy());
  }
}

void checkSave(const Scene& scene) {
  const std::string input = "--save " + scene.save;
  if (scene.save.empty()) {
    if (scene.save_every_s == 0) return;
    throw Error(Error::Code::kBadInput, fmt::format("--save-every {:g}", scene.save_every_s),
                "there is no file to save", "name one, for example --save sculpted.vdb, or leave --save-every out");
  }
  if (!isVolumeFileName(scene.save)) {
    throw Error(Error::Code::kBadInput, input, "its suffix names no format that volumes are written in",
                fmt::format("use one of {}", kVolumeFileSuffixes));
  }
  checkNotInput(scene.volume, scene.save);
  static_cast<void>(AtomicFile(scene.save));  // a folder that may not be written
}

}  // namespace

void checkEditOptions(const Scene& scene) {
  if (!scene.edit.empty()) static_cast<void>(toolBrushSpec(scene.edit));
  if (!scene.edit.empty() && algorithmEntry(scene.algorithm).needs.isosurface_mesh) {
    throw Error(Error::Code::kBadInput, "--edit " + scene.edit,
                fmt::format("{} feels a mesh that is made once, before the run", scene.algorithm),
                "choose another --algorithm, for example hri");
  }
  for (const auto& [flag, value] : {std::pair("--journal", &scene.journal), std::pair("--save", &scene.save)}) {
    if (!scene.edit.empty() || value->empty()) continue;
    throw Error(Error::Code::kBadInput, fmt::format("{} {}", flag, *value), "nothing is edited",
                fmt::format("give a brush, for example --edit remove:radius=2mm, or leave {} out", flag));
  }
  checkSave(scene);
}

LiveEdits::LiveEdits(const Scene& scene, Volume& volume, Engine& engine)
    : scene_(scene),
      brush_(toolBrushSpec(scene.edit), volume.size(), volume.lattice()),
      session_(
          engine,
          [&] {
            const BrushProfile profile = brushProfile(volume, *scene.isovalue);
            checkBrush(toolBrushSpec(scene.edit).brush, scene.edit, volume, profile);
            return profile;
          }(),
          std::vector{toolBrushSpec(scene.edit).brush.kind}, kHistoryBytes) {
  const std::string fine = fineBrushWords(toolBrushSpec(scene.edit).brush, volume.lattice(), engine.profile());
  if (!fine.empty()) tell("--edit " + scene.edit + ": " + fine, Again::kTell);
  if (!scene.journal.empty()) session_.keepJournal(scene.journal, identityOf(volume), watchedJournal());
  if (scene.save.empty()) return;
  volume.keepIsovalue(*scene.isovalue);
  const auto write = [file = scene.save](const Volume& edited, std::uint64_t) { return saveVolume(edited, file); };
  session_.keepSaved(volume, write, scene.save_every_s);
}

LiveEdits::~LiveEdits() {
  if (!finished_) session_.dropEmptyJournal();
}

void LiveEdits::tell(const std::string& text, Again again) {
  std::string reason;
  std::copy_if(text.begin(), text.end(), std::back_inserter(reason), [](char c) { return c < '0' || c > '9'; });
  const auto known =
      std::find_if(troubles_.begin(), troubles_.end(), [&](const Trouble& t) { return t.reason == reason; });
  if (known == troubles_.end()) {
    troubles_.push_back({std::move(reason), text});
  } else {
    ++known->count;
    if (again == Again::kCountOnly) return;
  }
  tellUser(text);
}

// What the engine has no room for, or cannot be meant at that place, is refused and nothing else: a removal may follow
// for which there is room. Any other error is the device's, and there is no more to edit on.
void LiveEdits::edit(std::span<const EditCommand> commands, std::int64_t now_ns) {
  if (!editing_) return;
  try {
    session_.edit(commands, now_ns);
  } catch (const Error& error) {
    if (error.code() == Error::Code::kOutOfMemory || error.code() == Error::Code::kBadInput) {
      ++refused_;
      brush_.refused();
      tell(fmt::format("an edit was refused: {}", error.what()), Again::kCountOnly);
      return;
    }
    editing_ = false;
    tell(fmt::format("editing has ended: {}", error.what()), Again::kTell);
  }
}

void LiveEdits::listen() {
  if (BackgroundSaver* saver = session_.saver(); saver != nullptr) {
    for (const std::string& failure : saver->takeFailures()) tell(failure, Again::kTell);
  }
  const JournalWriter* journal = session_.journal();
  if (journal == nullptr || journal_failed_ || !journal->failed()) return;
  journal_failed_ = true;
  tell(journal->failure(), Again::kTell);
}

void LiveEdits::follow(const ToolPose& pose, std::int64_t now_ns) {
  if (const std::vector<EditCommand> commands = brush_.look(pose, now_ns); !commands.empty()) edit(commands, now_ns);
  session_.look(now_ns);
  listen();
}

RunEdits LiveEdits::finish(std::vector<std::string>& notes) {
  finished_ = true;
  session_.close();
  listen();
  for (const Trouble& trouble : troubles_) {
    notes.push_back(trouble.count > 1 ? fmt::format("{} times, first: {}", trouble.count, trouble.text) : trouble.text);
  }
  EditFigures figures = session_.figures();
  RunEdits edits{figures.edits,         figures.windows,        {}, figures.journalled, figures.acknowledged,
                 figures.journal_bytes, figures.journal_failure};
  for (const double seconds : figures.edit_to_window_s) edits.edit_to_window_ms.push_back(seconds * 1e3);
  edits.refused = refused_;
  edits.saves = figures.saves.seconds.size();
  edits.save_failures = figures.saves.failures;
  edits.save_bytes = figures.saves.bytes;
  edits.save_version = figures.saves.version;
  edits.save_s = std::move(figures.saves.seconds);
  edits.save_failure = std::move(figures.saves.failure);
  return edits;
}

std::string keptEdits(const Scene& scene, const RunEdits& edits) {
  std::string words;
  if (edits.save_version)
    words = fmt::format("{} holds the volume up to edit {} of {}", scene.save, *edits.save_version, edits.count);
  if (edits.journal_saved > 0) {
    // A tool makes edits and nothing else, so the number of a record is that of its edit.
    words += fmt::format("{}the journal {} holds edits up to number {}: see 'palpate recover'",
                         words.empty() ? "" : ", ", scene.journal, edits.journal_saved);
  }
  if (!scene.save.empty() && !edits.save_failure.empty())
    words += fmt::format("{}{} was not written anew ({})", words.empty() ? "" : ", ", scene.save, edits.save_failure);
  return words;
}

bool lostEdits(const RunEdits& edits) {
  return !edits.save_failure.empty() || !edits.journal_failure.empty();
}

std::string LiveEdits::kept(const RunEdits& edits) {
  session_.dropEmptyJournal();
  const std::string words = keptEdits(scene_, edits);
  return words.empty() ? "nothing was written; start it again" : "no report was written, but " + words;
}

std::string LiveEdits::finishFailed() noexcept {
  std::vector<std::string> notes;
  try {
    return kept(finish(notes));
  } catch (const std::exception& error) {
    return fmt::format("what was edited could not be saved ({})", error.what());
  }
}

void LiveEdits::during(const std::function<void()>& work) {
  try {
    work();
  } catch (const Error& error) {
    throw Error(error.code(), error.input(), error.reason(), error.remedy() + "; " + finishFailed());
  } catch (...) {
    tell(finishFailed(), Again::kTell);
    throw;
  }
}

}  // namespace palpate
