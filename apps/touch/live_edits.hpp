// SPDX-License-Identifier: Apache-2.0
// apps/touch/live_edits.hpp: the edits of a run: the servo's tool drives a brush through an editing session.
//
// Thread: made and finished by the job's thread, in between the engine's. An edit that the engine refuses (no memory
// left, say), a journal that fails and a save that fails end neither the run nor the editing. All are told at once, on
// stderr, and in the run's notes: refusals and failures for the same reason once, with their count.
#pragma once

#include <functional>
#include <span>
#include <string>
#include <vector>

#include "apps/report/touch_run.hpp"
#include "engine/plan/scene.hpp"
#include "engine/session/edit_session.hpp"
#include "engine/session/tool_brush.hpp"

namespace palpate {

// Throws Error on an --edit, --journal or --save that cannot be meant (kBadInput) or a file that cannot be made there
// (kIo), before any volume is loaded.
void checkEditOptions(const Scene& scene);

// What there is of a run's edits, in words that end a message; empty: nothing. And whether not all is there: the newest
// save failed, or the journal lost records.
[[nodiscard]] std::string keptEdits(const Scene& scene, const RunEdits& edits);
[[nodiscard]] bool lostEdits(const RunEdits& edits);

class LiveEdits {
 public:
  // `scene.isovalue` is the one in use. With --save `volume` belongs to this until finish(): nobody else may look at
  // it. Throws Error: a brush that does not fit the volume, a journal that cannot be kept there.
  LiveEdits(const Scene& scene, Volume& volume, Engine& engine);
  ~LiveEdits();  // without finish() the run has failed: a journal without a record is gone
  LiveEdits(const LiveEdits&) = delete;
  LiveEdits& operator=(const LiveEdits&) = delete;

  // With every look at the tool; edits when one is due, saves when that is.
  void follow(const ToolPose& pose, std::int64_t now_ns);

  // After the run: waits for the journal, and saves what no file holds yet; where there is a --save, `volume` is then
  // the edited one. Adds what went wrong to `notes`.
  [[nodiscard]] RunEdits finish(std::vector<std::string>& notes);
  // After finish(), where the run ends without its reports: what there is of the edits, in words that end an error. A
  // journal without a record is gone then.
  [[nodiscard]] std::string kept(const RunEdits& edits);
  void dropEmptyJournal() { session_.dropEmptyJournal(); }
  // Does the work in which follow() is called. Where it throws, what was edited until then is saved as by finish(), and
  // the error says so.
  void during(const std::function<void()>& work);

 private:
  // Something that went wrong, as it was told first, and how often.
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
