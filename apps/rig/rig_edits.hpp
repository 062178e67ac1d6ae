// SPDX-License-Identifier: Apache-2.0
// apps/rig/rig_edits.hpp: what edits the volume while a rig runs: the tool as a brush, and edits, undo and redo that
// anybody asks for.
//
// Requests are done in order, one at each look at the tool, so that windows follow the tool in between. A refused edit
// (out of memory, for example), a failed journal or a failed save ends neither the run nor the editing. A failed device
// ends the editing; of a session that can go on with another engine (EditSession::keepAbreast()) what is asked for then
// waits for goOn(). The user is told of each at once; of repeated ones with the same reason only once, with a count.
//
// Threads: requests may come from any thread. Everything else belongs to the engine's thread: the maker's before and
// after a run, the rig's during it. Cost of a request and of state(): a lock, held no longer than a
// copy of the list of steps.
#pragma once

#include <cstdint>
#include <deque>
#include <functional>
#include <mutex>
#include <optional>
#include <string>
#include <vector>

#include "base/error.hpp"
#include "base/lattice.hpp"
#include "engine/session/edit_session.hpp"
#include "engine/session/tool_brush.hpp"

namespace palpate {

class RigEdits {
 public:
  using Tell = std::function<void(const std::string&)>;
  // The session must outlive this object, and keep abreast already if it is to. `size`, `lattice`: the volume's. `tell`
  // gets each failure, on the engine's thread.
  RigEdits(EditSession& session, const Vec3i& size, const Lattice& lattice, Tell tell);

  // Requests, from any thread. Return false and do nothing if kMostWaiting requests wait already or editing has ended.
  // `done`, if given, is told once what became of the request, by the engine's thread, or by whoever ends the editing:
  // empty, it was made; else why not. Such a refusal is not told to the user, too.
  using Done = std::function<void(const std::optional<Error>& refusal)>;
  bool edit(std::vector<EditCommand> commands, Done done = {});
  bool undo(Done done = {});
  bool redo(Done done = {});
  // Undoes or redoes, one at each look, until so many of State::steps are in effect. Drops the brush first.
  bool goTo(std::size_t done);
  // A brush for the tool. All that it does is undone as one, until it is dropped or another change comes between.
  bool setBrush(const ToolBrushSpec& brush);
  bool dropBrush();  // also where too many requests wait
  // Before a run: from these ticks on the tool holds these brushes, or none. The ticks ascend. A scripted session's, in
  // which nobody lets go of a brush: a stroke ends, too, when the tool has been away from the surface for
  // kStrokePause_s.
  struct ScheduledBrush {
    std::int64_t tick = 0;
    std::optional<ToolBrushSpec> brush;
  };
  void follow(std::vector<ScheduledBrush> brushes);
  static constexpr double kStrokePause_s = 0.5;  // [s]
  bool errand(BackgroundSaver::Errand errand);   // EditSession::ask()
  static constexpr std::size_t kMostWaiting = 256;
  static constexpr std::size_t kMostTroubles = 100;  // that are kept; a service may go on for days

  // The state after the last look. Any thread.
  struct Counts {
    std::uint64_t edits = 0;            // made, undo and redo included
    std::uint64_t refused = 0;          // edits, undo and redo that were not made
    std::uint64_t content_version = 0;  // EditSession::contentVersion()
    std::size_t done = 0;               // steps that can be undone
    std::size_t undone = 0;             // and redone
    std::size_t forgotten = 0;          // edits in effect that cannot be undone any more
    std::size_t waiting = 0;            // requests
    bool editing = true;                // false: the device has failed, and nothing more is edited
  };
  [[nodiscard]] Counts counts() const;  // a lock, and no copy of a list
  struct State : Counts {
    [[nodiscard]] bool canUndo() const noexcept { return done > 0; }
    [[nodiscard]] bool canRedo() const noexcept { return undone > 0; }
    std::vector<UndoLabel> steps;  // done and undone, the oldest first
  };
  [[nodiscard]] State state() const;

  // To be called with every new pose of the tool: does one request, the tool's edit if one is due, and a save if one is
  // due.
  void look(const ToolPose& pose, std::int64_t now_ns);
  // After a run: does the requests that still wait.
  void doWaiting(std::int64_t now_ns);
  // After a failed device, once the session has gone on with another engine: requests are taken again.
  void goOn();
  // For the end: what waits is given up, and nothing more is taken.
  void end();
  // Tells the user what has failed in the background since the last call.
  void listen();
  // Tells the user `text`, like a failure.
  void tell(const std::string& text) { tell(text, Again::kTell); }
  // The first kMostTroubles kinds of failures, with counts.
  [[nodiscard]] std::vector<std::string> troubles() const;

 private:
  using Request = std::function<void(std::int64_t now_ns)>;
  enum class Room { kAsUsual, kAlways };
  bool ask(Request request, Room room = Room::kAsUsual);
  [[nodiscard]] Request next();
  enum class Pauses { kEndAStroke, kBelongToIt };
  void hold(const std::optional<ToolBrushSpec>& brush, Pauses pauses);
  [[nodiscard]] bool endsAStroke(const ToolPose& pose, std::int64_t now_ns);
  void stroke(const ToolPose& pose, std::int64_t now_ns);
  void stepTowards(std::size_t done, std::int64_t now_ns);
  void noteState();  // the caller holds the lock
  class Promise;
  bool askFor(const char* what, Done done, std::function<void(std::int64_t now_ns)> change);
  template <typename Change>
  bool tryTo(const char* what, const Change& change, Promise* promise = nullptr);

  // A refusal or failure: its first message, and how often it happened.
  struct Trouble {
    std::string reason;  // the text without its numbers
    std::string text;
    std::uint64_t count = 1;
  };
  enum class Again { kTell, kCountOnly };
  void tell(const std::string& text, Again again);

  EditSession& session_;
  const bool outlives_its_engine_;  // what waits then waits for the next one
  const Vec3i size_;
  const Lattice lattice_;
  const Tell tell_;
  std::optional<ToolBrush> brush_;
  Pauses pauses_ = Pauses::kBelongToIt;
  bool in_a_stroke_ = false;                   // the last change was this brush's
  std::optional<std::int64_t> away_since_ns_;  // the first look that saw it away from the surface
  std::deque<ScheduledBrush> scheduled_;
  std::vector<Trouble> troubles_;
  bool journal_failed_ = false;       // and that was told
  std::uint64_t journal_mended_ = 0;  // JournalWriter::timesMended(), as it was told
  mutable std::mutex mutex_;          // guards what follows
  std::deque<Request> waiting_;
  bool has_ended_ = false;
  State state_;
};

}  // namespace palpate
