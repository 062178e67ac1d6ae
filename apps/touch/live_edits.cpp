// SPDX-License-Identifier: Apache-2.0
#include "apps/touch/live_edits.hpp"

#include <cmath>
#include <limits>
#include <set>
#include <utility>

#include <fmt/format.h>

#include "apps/console/message.hpp"
#include "apps/path/path_csv.hpp"
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

// Tries the brush somewhere in the volume, so that its errors are found before the run.
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
                fmt::format("use one of {}", volumeFileSuffixes()));
  }
  checkNotInput(scene.volume, scene.save);
  static_cast<void>(AtomicFile(scene.save));  // refuses a folder without write permission
}

// The one that is given from the first tick on, or those of the path file.
std::vector<HeldBrush> brushesOf(const Scene& scene) {
  std::vector<HeldBrush> brushes;
  if (!scene.path_file.empty()) brushes = readPathFile(scene.path_file).brushes;
  if (brushes.empty()) brushes.push_back({0, scene.edit});
  return brushes;
}

std::vector<EditKind> kindsOf(const std::vector<HeldBrush>& brushes) {
  std::set<EditKind> kinds;
  for (const HeldBrush& held : brushes) {
    if (!held.text.empty()) kinds.insert(toolBrushSpec(held.text).brush.kind);
  }
  return {kinds.begin(), kinds.end()};
}

}  // namespace

Scene withRecordedBrush(const Scene& scene) {
  if (scene.path_file.empty()) return scene;
  const std::vector<HeldBrush> brushes = readPathFile(scene.path_file).brushes;
  if (brushes.empty()) return scene;
  if (!scene.edit.empty()) {
    throw Error(Error::Code::kBadInput, "--edit " + scene.edit,
                fmt::format("the path {} says itself where the tool edits, and how", scene.path_file),
                "leave --edit out, or the file's last column");
  }
  for (const HeldBrush& held : brushes) {
    if (held.text.empty()) continue;
    try {
      static_cast<void>(toolBrushSpec(held.text));
    } catch (const Error& error) {
      throw Error(error.code(),
                  fmt::format("{}, {:g} s after its first row: {}", scene.path_file, held.begin_s, held.text),
                  error.reason(), error.remedy());
    }
  }
  Scene edited = scene;
  edited.edit = brushes.front().text;
  return edited;
}

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
      brushes_(brushesOf(scene)),
      session_(
          engine,
          [&] {
            const BrushProfile profile = brushProfile(volume, *scene.isovalue);
            for (const HeldBrush& held : brushes_) {
              if (!held.text.empty()) checkBrush(toolBrushSpec(held.text).brush, held.text, volume, profile);
            }
            return profile;
          }(),
          kindsOf(brushes_), kHistoryBytes),
      edits_(session_, volume.size(), volume.lattice(), tellUser) {
  std::vector<RigEdits::ScheduledBrush> scheduled;
  std::set<std::string> told;
  for (const HeldBrush& held : brushes_) {
    RigEdits::ScheduledBrush& one = scheduled.emplace_back();
    one.tick = held.begin_s > 0 ? std::llround(held.begin_s * scene.rate_hz) : std::numeric_limits<std::int64_t>::min();
    if (held.text.empty()) continue;
    one.brush = toolBrushSpec(held.text);
    const std::string fine = fineBrushWarning(one.brush->brush, volume.lattice(), Strokes::kMany);
    if (!fine.empty() && told.insert(held.text).second) edits_.tell("--edit " + held.text + ": " + fine);
  }
  edits_.follow(std::move(scheduled));
  if (!scene.journal.empty()) session_.keepJournal(scene.journal, identityOf(volume), watchedJournal());
  if (scene.save.empty()) return;
  volume.keepIsovalue(*scene.isovalue);
  const auto write = [file = scene.save](const Volume& edited, std::uint64_t) { return saveVolume(edited, file); };
  session_.keepSaved(volume, write, scene.save_every_s);
}

LiveEdits::~LiveEdits() {
  if (!finished_) session_.dropEmptyJournal();
}

RunEdits LiveEdits::finish(std::vector<std::string>& notes) {
  finished_ = true;
  session_.close();
  edits_.listen();
  for (std::string& trouble : edits_.troubles()) notes.push_back(std::move(trouble));
  return runEdits(session_.figures(), edits_.state().refused);
}

RunEdits runEdits(EditFigures figures, std::uint64_t refused) {
  RunEdits edits{figures.edits,         figures.windows,        {}, figures.journalled, figures.acknowledged,
                 figures.journal_bytes, figures.journal_failure};
  for (const double seconds : figures.edit_to_window_s) edits.edit_to_window_ms.push_back(seconds * 1e3);
  edits.refused = refused;
  edits.saves = figures.saves.saves;
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
    // The tool makes no undo or redo, so the number of a record is that of its edit.
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

void LiveEdits::dropEmptyJournal(RunEdits& edits) {
  session_.dropEmptyJournal();
  if (const JournalWriter* journal = session_.journal(); journal != nullptr) edits.journal_bytes = journal->bytes();
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
    edits_.tell(finishFailed());
    throw;
  }
}

}  // namespace palpate
