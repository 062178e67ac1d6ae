// SPDX-License-Identifier: Apache-2.0
// The hand's way in the guest, for the device and for the client that compares: down onto a wall and along it.
#pragma once

#include "servo/devices/path.hpp"

namespace palpate {

inline constexpr double kGuestTick_s = 1e-3;

inline SampledPath guestWay() {
  return {{0, 0.3, 0.6, 0.9},
          {Vec3(0, 0.02, 0), Vec3(0, -0.008, 0), Vec3(0.02, -0.008, 0.01), Vec3(0, 0.02, 0)},
          SampledPath::Interpolation::kCubic};
}

}  // namespace palpate
