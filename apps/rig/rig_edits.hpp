// SPDX-License-Identifier: Apache-2.0
// apps/rig/rig_edits.hpp: what edits the volume while a rig runs: the tool as a brush, and edits, undo and redo that
// anybody asks for.
//
// Requests are done in their order, one at a look at the tool, so that windows follow the tool in between. A refused
// edit (out of memory, for example), a failed journal and a failed save end neither the run nor the editing; a failing
// device ends the editing. Each is told at once; repeated ones with the same reason are told once and counted.
// Threads: what asks is any thread's; the rest is whose the engine is: the maker's before and after a run, else that
// of the rig's look. Cost of asking: a lock, held for no longer than a move.
#pragma once

#include <cstdint>
#include <deque>
#include <functional>
#include <mutex>
#include <optional>
#include <string>
#include <vector>

#include "base/lattice.hpp"
#include "engine/session/edit_session.hpp"
#include "engine/session/tool_brush.hpp"

namespace palpate {

class RigEdits {
 public:
  using Tell = std::function<void(const std::string&)>;
  // The session outlives this. `size`, `lattice`: the volume's. `tell` gets each trouble, from the thread that has the
  // engine.
  RigEdits(EditSession& session, const Vec3i& size, const Lattice& lattice, Tell tell);

  // Any thread. False: kMostWaiting requests wait already, or editing has ended; then nothing comes of it.
  bool edit(std::vector<EditCommand> commands);
  bool undo();
  bool redo();
  bool setBrush(const ToolBrushSpec& brush);  // of the tool
  bool dropBrush();
  static constexpr std::size_t kMostWaiting = 256;

  // Any thread: how things stood after the last look.
  struct State {
    std::uint64_t edits = 0;    // made, undo and redo included
    std::uint64_t refused = 0;  // edits, undo and redo that were not made
    bool can_undo = false, can_redo = false;
    bool editing = true;  // false: the device has failed, and nothing more is edited
  };
  [[nodiscard]] State state() const;

  // With every new pose of the tool: does one request, and the tool's edit if one is due; saves if that is due.
  void look(const ToolPose& pose, std::int64_t now_ns);
  // Tells what has failed in the background since the last look.
  void listen();
  // At once, as what a look meets.
  void tell(const std::string& text) { tell(text, Again::kTell); }
  // What was told until now, with counts.
  [[nodiscard]] std::vector<std::string> troubles() const;

 private:
  using Request = std::function<void(std::int64_t now_ns)>;
  bool ask(Request request);
  [[nodiscard]] Request next();
  template <typename Change>
  bool tryTo(const char* what, const Change& change);

  // A refusal or failure: its first message, and how often it happened.
  struct Trouble {
    std::string reason;  // the text without its numbers
    std::string text;
    std::uint64_t count = 1;
  };
  enum class Again { kTell, kCountOnly };
  void tell(const std::string& text, Again again);

  EditSession& session_;
  const Vec3i size_;
  const Lattice lattice_;
  const Tell tell_;
  std::optional<ToolBrush> brush_;
  std::vector<Trouble> troubles_;
  bool journal_failed_ = false;
  mutable std::mutex mutex_;  // guards what follows
  std::deque<Request> waiting_;
  State state_;
};

}  // namespace palpate
