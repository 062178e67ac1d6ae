// SPDX-License-Identifier: Apache-2.0
#include "apps/sculpt/key_pointer.hpp"

#include <algorithm>

namespace palpate {

void KeyPointer::take(const PointerKeys& keys, double dt_s, double width, double height, PointerInput& input) {
  const bool mouse = input.dx != 0 || input.dy != 0 || input.left || input.middle || input.right || input.wheel != 0;
  if (!keys.press) waits_for_release_ = false;
  if (mouse) {
    leads_ = false;
    waits_for_release_ = keys.press;  // what the keys pressed is over: it shall not begin anew elsewhere
    return;
  }
  if (!keys.any() && !leads_) return;
  if (!leads_) {  // from where the mouse left it, or from the middle
    x_ = input.over ? input.x : width / 2;
    y_ = input.over ? input.y : height / 2;
    leads_ = true;
  }
  const double right = (keys.right ? 1 : 0) - (keys.left ? 1 : 0), down = (keys.down ? 1 : 0) - (keys.up ? 1 : 0);
  const double way_px = std::min(dt_s, kMost_s) * height;
  if (input.ctrl && !keys.press) {
    input.middle = right != 0 || down != 0;
    input.dx = kTurn * way_px * right;
    input.dy = kTurn * way_px * down;
    input.ctrl = false;  // it says that the arrows drag, not how
  } else {
    input.dx = kMove * way_px * right;
    input.dy = kMove * way_px * down;
    x_ = std::clamp(x_ + input.dx, 0.0, width - 1);
    y_ = std::clamp(y_ + input.dy, 0.0, height - 1);
  }
  input.x = x_;
  input.y = y_;
  input.over = true;
  input.left = keys.press && !waits_for_release_;
  input.wheel = keys.wheel;
}

}  // namespace palpate
