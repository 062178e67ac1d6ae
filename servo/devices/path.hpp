// SPDX-License-Identifier: Apache-2.0
// servo/devices/path.hpp: where a hand wants to be, over time.
//
// Frame W: world [m], time since the start [s]. Thread: const, so any. Heap: position() allocates nothing. Errors:
// none; before 0 and after the end the path rests at its ends.
#pragma once

#include "base/vec.hpp"

namespace palpate {

class Path {
 public:
  virtual ~Path() = default;
  [[nodiscard]] virtual Vec3 position(double time_s) const noexcept = 0;  // [m]
  [[nodiscard]] virtual double duration_s() const noexcept = 0;           // [s]
};

}  // namespace palpate
