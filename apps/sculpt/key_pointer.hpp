// SPDX-License-Identifier: Apache-2.0
// apps/sculpt/key_pointer.hpp: the pointer led by keys, so that all can be done without a mouse. One thread; no cost.
//
//   arrows                 move the pointer over the picture; with Ctrl turn the object, with Ctrl and Shift move it
//   Space                  the left button; with Ctrl the opposite brush, with Shift smoothing
//   Page up, Page down     the wheel
//
// The mouse leads again as soon as it moves or a button of it is pressed.
#pragma once

#include "apps/sculpt/gestures.hpp"

namespace palpate {

struct PointerKeys {
  bool left = false, right = false, up = false, down = false;  // held
  bool press = false;                                          // held: Space
  double wheel = 0;                                            // steps since the last frame
  [[nodiscard]] bool any() const noexcept { return left || right || up || down || press || wheel != 0; }
};

class KeyPointer {
 public:
  // What the keys make of the mouse's `input`. `dt_s`: since the last frame. A picture of this size [pixel].
  void take(const PointerKeys& keys, double dt_s, double width, double height, PointerInput& input);
  [[nodiscard]] bool leads() const noexcept { return leads_; }

  static constexpr double kMove = 0.25;   // of the pointer: pictures' heights a second
  static constexpr double kTurn = 0.5;    // of a turn or a move of the object: the same
  static constexpr double kMost_s = 0.1;  // a longer frame counts as this

 private:
  bool leads_ = false;
  bool waits_for_release_ = false;  // of a press that the mouse has ended
  double x_ = 0, y_ = 0;
};

}  // namespace palpate
