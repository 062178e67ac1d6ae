// SPDX-License-Identifier: Apache-2.0
// apps/touch/live_edits.hpp: the edits of a run as a scene names them: a brush for the tool, a journal, saves.
//
// Thread: the job's thread makes and finishes it; in between it belongs to the engine's thread. What goes wrong
// meanwhile (apps/rig/rig_edits.hpp) is reported on stderr at once and in the run's notes.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "apps/path/timed_point.hpp"
#include "apps/report/touch_run.hpp"
#include "apps/rig/rig_edits.hpp"
#include "apps/scene/scene.hpp"
#include "engine/session/edit_session.hpp"

namespace palpate {

// The scene with the first brush of its path file as --edit, so that it edits at all; the scene itself where the file
// holds none. Throws Error as readPathFile() does, and kBadInput if there is an --edit too.
[[nodiscard]] Scene withRecordedBrush(const Scene& scene);

// Checks --edit, --journal and --save before any volume is loaded. Throws Error: kBadInput for invalid ones, kIo for a
// place where no file can be made.
void checkEditOptions(const Scene& scene);

// A session's figures as those of a run. `refused`: edits that were refused.
[[nodiscard]] RunEdits runEdits(EditFigures figures, std::uint64_t refused);

// keptEdits: which of a run's edits are on disk, as the end of a message; empty: none. lostEdits: whether some are not,
// as the newest save failed or the journal lost records.
[[nodiscard]] std::string keptEdits(const Scene& scene, const RunEdits& edits);
[[nodiscard]] bool lostEdits(const RunEdits& edits);

class LiveEdits {
 public:
  // `scene.isovalue` is set to the one in use. With --save, `volume` belongs to this object until finish(): nobody else
  // may look at it. The tool holds the brushes of the path file where it has some. Throws Error for a brush that does
  // not fit the volume, and for a journal that cannot be made.
  LiveEdits(const Scene& scene, Volume& volume, Engine& engine);
  ~LiveEdits();  // without finish() the run has failed; then deletes a journal without a record
  LiveEdits(const LiveEdits&) = delete;
  LiveEdits& operator=(const LiveEdits&) = delete;

  [[nodiscard]] RigEdits& edits() noexcept { return edits_; }  // for the rig

  // After the run: waits for the journal and saves the volume if the newest file lacks an edit. With --save, `volume`
  // then holds every edit. Adds refusals and failures to `notes`.
  [[nodiscard]] RunEdits finish(std::vector<std::string>& notes);
  // After finish(), for a run that ends without its reports: which edits are on disk, as the end of an error message.
  // Deletes a journal without a record.
  [[nodiscard]] std::string kept(const RunEdits& edits);
  // Likewise for a run that ended early; `edits` then knows of no journal.
  void dropEmptyJournal(RunEdits& edits);
  // Runs `work`, the run. If it throws, saves the edits so far as finish() does and adds that to the
  // error.
  void during(const std::function<void()>& work);

 private:
  [[nodiscard]] std::string finishFailed() noexcept;

  Scene scene_;
  std::vector<HeldBrush> brushes_;
  EditSession session_;
  RigEdits edits_;
  bool finished_ = false;
};

}  // namespace palpate
