// SPDX-License-Identifier: Apache-2.0
// apps/touch/live_edits.hpp: the edits of a run: the servo's tool drives a brush through an editing session.
//
// Thread: the job's thread makes and finishes it; in between it belongs to the engine's thread. A refused edit (out of
// memory, for example), a failed journal and a failed save end neither the run nor the editing. Each is reported on
// stderr at once and in the run's notes. Repeated ones with the same reason are reported once, with their count.
#pragma once

#include <functional>
#include <span>
#include <string>
#include <vector>

#include "apps/report/touch_run.hpp"
#include "apps/scene/scene.hpp"
#include "engine/session/edit_session.hpp"
#include "engine/session/tool_brush.hpp"

namespace palpate {

// Checks --edit, --journal and --save before any volume is loaded. Throws Error: kBadInput for invalid ones, kIo for a
// place where no file can be made.
void checkEditOptions(const Scene& scene);

// keptEdits: which of a run's edits are on disk, as the end of a message; empty: none. lostEdits: whether some are not,
// as the newest save failed or the journal lost records.
[[nodiscard]] std::string keptEdits(const Scene& scene, const RunEdits& edits);
[[nodiscard]] bool lostEdits(const RunEdits& edits);

class LiveEdits {
 public:
  // `scene.isovalue` is set to the one in use. With --save, `volume` belongs to this object until finish(): nobody else
  // may look at it. Throws Error for a brush that does not fit the volume, and for a journal that cannot be made.
  LiveEdits(const Scene& scene, Volume& volume, Engine& engine);
  ~LiveEdits();  // without finish() the run has failed; then deletes a journal without a record
  LiveEdits(const LiveEdits&) = delete;
  LiveEdits& operator=(const LiveEdits&) = delete;

  // Called with every new pose of the tool. Makes an edit when one is due, and a save when one is due.
  void follow(const ToolPose& pose, std::int64_t now_ns);

  // After the run: waits for the journal and saves the volume if the newest file lacks an edit. With --save, `volume`
  // then holds every edit. Adds refusals and failures to `notes`.
  [[nodiscard]] RunEdits finish(std::vector<std::string>& notes);
  // After finish(), for a run that ends without its reports: which edits are on disk, as the end of an error message.
  // Deletes a journal without a record.
  [[nodiscard]] std::string kept(const RunEdits& edits);
  void dropEmptyJournal() { session_.dropEmptyJournal(); }
  // Runs `work`, which calls follow(). If it throws, saves the edits so far as finish() does and adds that to the
  // error.
  void during(const std::function<void()>& work);

 private:
  // A refusal or failure: its first message, and how often it happened.
  struct Trouble {
    std::string reason;  // the text without its numbers
    std::string text;
    std::uint64_t count = 1;
  };
  enum class Again { kTell, kCountOnly };
  void tell(const std::string& text, Again again);
  void edit(std::span<const EditCommand> commands, std::int64_t now_ns);
  void listen();
  [[nodiscard]] std::string finishFailed() noexcept;

  Scene scene_;
  ToolBrush brush_;
  EditSession session_;
  std::vector<Trouble> troubles_;
  std::uint64_t refused_ = 0;
  bool editing_ = true;
  bool journal_failed_ = false;
  bool finished_ = false;
};

}  // namespace palpate
