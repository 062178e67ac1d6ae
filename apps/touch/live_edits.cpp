// SPDX-License-Identifier: Apache-2.0
#include "apps/touch/live_edits.hpp"

#include <cstdlib>
#include <memory>

#include <fcntl.h>
#include <fmt/format.h>
#include <unistd.h>

#include "base/error.hpp"
#include "engine/journal/volume_identity.hpp"
#include "servo/algorithms/registry.hpp"

namespace palpate {
namespace {

constexpr std::size_t kHistoryBytes = 0;  // a scripted run undoes nothing

// The brush somewhere in the volume, to find out what is wrong with it before the run.
void checkBrush(const EditCommand& brush, const Volume& volume) {
  EditCommand command = brush;
  command.from_W = command.to_W = volume.lattice().toWorld((volume.size() / 2).cast<double>());
  checkEdit(command, volume.size(), volume.lattice());
}

// For who watches from outside (docs/journal.md): the newest acknowledged number, as text of one length, so that a
// reader never sees half of one.
class AcknowledgedFile {
 public:
  explicit AcknowledgedFile(const char* name)
      : descriptor_(open(name, O_WRONLY | O_CREAT | O_TRUNC | O_CLOEXEC, 0666)) {}
  ~AcknowledgedFile() {
    if (descriptor_ >= 0) close(descriptor_);
  }
  AcknowledgedFile(const AcknowledgedFile&) = delete;
  AcknowledgedFile& operator=(const AcknowledgedFile&) = delete;
  void set(std::uint64_t newest) const {
    const std::string text = fmt::format("{:020}\n", newest);
    if (descriptor_ >= 0) static_cast<void>(!pwrite(descriptor_, text.data(), text.size(), 0));
  }

 private:
  int descriptor_;
};

JournalOptions journalOptions() {
  JournalOptions options;
  if (const char* name = std::getenv("PALPATE_ACKNOWLEDGED"); name != nullptr) {
    options.on_acknowledged = [file = std::make_shared<AcknowledgedFile>(name)](std::uint64_t newest) {
      file->set(newest);
    };
  }
  return options;
}

}  // namespace

void checkEditOptions(const Scene& scene) {
  if (!scene.edit.empty()) static_cast<void>(toolBrushSpec(scene.edit));
  if (!scene.edit.empty() && algorithmEntry(scene.algorithm).needs.isosurface_mesh) {
    throw Error(Error::Code::kBadInput, "--edit " + scene.edit,
                fmt::format("{} feels a mesh that is made once, before the run", scene.algorithm),
                "choose another --algorithm, for example hri");
  }
  if (scene.edit.empty() && !scene.journal.empty()) {
    throw Error(Error::Code::kBadInput, "--journal " + scene.journal, "nothing is edited",
                "give a brush, for example --edit remove:radius=2mm, or leave --journal out");
  }
}

LiveEdits::LiveEdits(const Scene& scene, const Volume& volume, Engine& engine)
    : brush_(toolBrushSpec(scene.edit), volume.size(), volume.lattice()),
      session_(
          engine,
          [&] {
            checkBrush(toolBrushSpec(scene.edit).brush, volume);
            return brushProfile(volume, *scene.isovalue);
          }(),
          std::vector{toolBrushSpec(scene.edit).brush.kind}, kHistoryBytes) {
  if (!scene.journal.empty()) session_.keepJournal(scene.journal, identityOf(volume), journalOptions());
}

void LiveEdits::tell(const std::string& trouble) {
  troubles_.push_back(trouble);
  fmt::print(stderr, "palpate: {}\n", trouble);
}

void LiveEdits::follow(const ToolPose& pose, std::int64_t now_ns) {
  if (!editing_) return;
  const std::vector<EditCommand> commands = brush_.look(pose, now_ns);
  if (commands.empty()) return;
  try {
    session_.edit(commands, now_ns);
  } catch (const Error& error) {
    editing_ = false;
    tell(fmt::format("editing has ended: {}", error.what()));
  }
  const JournalWriter* journal = session_.journal();
  if (journal == nullptr || journal_failed_ || journal->failure().empty()) return;
  journal_failed_ = true;
  tell(journal->failure());
}

RunEdits LiveEdits::finish(std::vector<std::string>& notes) {
  session_.close();
  EditFigures figures = session_.figures();
  if (!figures.journal_failure.empty() && !journal_failed_) tell(figures.journal_failure);
  notes.insert(notes.end(), troubles_.begin(), troubles_.end());
  RunEdits edits{figures.edits,         figures.windows,        {}, figures.journalled, figures.acknowledged,
                 figures.journal_bytes, figures.journal_failure};
  for (const double seconds : figures.edit_to_window_s) edits.edit_to_window_ms.push_back(seconds * 1e3);
  return edits;
}

}  // namespace palpate
