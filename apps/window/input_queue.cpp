// SPDX-License-Identifier: Apache-2.0
#include "apps/window/input_queue.hpp"

namespace palpate {
namespace {

template <std::size_t N>
bool within(int code, const std::array<bool, N>&) {
  return code >= 0 && static_cast<std::size_t>(code) < N;
}

}  // namespace

const InputState& InputQueue::nextFrame() {
  std::array<bool, InputState::kButtons> button_changed{};
  std::array<bool, InputState::kKeys> key_changed{};
  bool clicked = false, pressed = false;
  state_.wheel_x = state_.wheel_y = 0;
  state_.text.clear();
  for (; !events_.empty(); events_.pop_front()) {
    const InputEvent& event = events_.front();
    switch (event.kind) {
      case InputEvent::Kind::kMove:
        if (clicked) return state_;
        state_.x = event.x;
        state_.y = event.y;
        break;
      case InputEvent::Kind::kButton:
        if (!within(event.code, state_.buttons)) break;
        if (button_changed[event.code] || (pressed && !event.down)) return state_;
        clicked = button_changed[event.code] = true;
        pressed |= event.down;
        state_.buttons[event.code] = event.down;
        break;
      case InputEvent::Kind::kKey:
        if (!within(event.code, state_.keys)) break;
        if (key_changed[event.code] || clicked || (pressed && !event.down)) return state_;
        key_changed[event.code] = true;
        pressed |= event.down;
        state_.keys[event.code] = event.down;
        break;
      case InputEvent::Kind::kWheel:
        state_.wheel_x += event.x;
        state_.wheel_y += event.y;
        break;
      case InputEvent::Kind::kText:
        state_.text.push_back(event.character);
        break;
      case InputEvent::Kind::kFocusLost:  // what is let go elsewhere is not told
        state_.buttons = {};
        state_.keys = {};
        break;
    }
  }
  return state_;
}

}  // namespace palpate
