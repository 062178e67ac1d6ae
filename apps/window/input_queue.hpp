// SPDX-License-Identifier: Apache-2.0
// apps/window/input_queue.hpp: what a person did, in order, given to the panels frame by frame so that nothing is lost.
//
// A key or button that goes down and up between two frames would not be seen: the panels look at states. So a frame
// takes events only as far as each of its changes can be told: no key or button twice; nothing is let go behind what
// was pressed, so that Ctrl is still held when a key counts; and no movement or key behind a button, so that a click is
// where and how it was made. What is left comes with the next frame. One thread; no cost.
#pragma once

#include <array>
#include <cstddef>
#include <deque>
#include <vector>

namespace palpate {

struct InputEvent {
  enum class Kind { kMove, kButton, kKey, kWheel, kText, kFocusLost };
  Kind kind = Kind::kMove;
  double x = 0, y = 0;  // of kMove [screen coordinates], of kWheel [step]
  int code = 0;         // button or key
  bool down = false;
  unsigned character = 0;  // of kText
};

struct InputState {
  static constexpr std::size_t kButtons = 5, kKeys = 512;
  double x = 0, y = 0;
  std::array<bool, kButtons> buttons{};
  std::array<bool, kKeys> keys{};
  // Of this frame alone.
  double wheel_x = 0, wheel_y = 0;
  std::vector<unsigned> text;
};

class InputQueue {
 public:
  void add(const InputEvent& event) { events_.push_back(event); }
  // The state after the events of the next frame.
  const InputState& nextFrame();
  [[nodiscard]] bool empty() const noexcept { return events_.empty(); }

 private:
  std::deque<InputEvent> events_;
  InputState state_;
};

}  // namespace palpate
