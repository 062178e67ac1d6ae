// SPDX-License-Identifier: Apache-2.0
// servo/devices/hand_friction.hpp: a tick of device and hand along one axis with dry friction, cut where the motion
// stops or breaks loose. Private to servo/devices.
//
// Between cuts friction is a constant force, and the motion that of a mass on spring and damper under a constant force,
// with its path going straight: a power series, taken over parts of a tick that are short against the system's own
// times, whose rest is below rounding. Any thread; no heap; no errors. Cost: 1 us, more where the system is stiff
// against the tick.
#pragma once

#include "servo/devices/hand_dynamics.hpp"

namespace palpate {

struct FrictionAxis {
  double position_m = 0, velocity_m_per_s = 0;
};
struct PathAxis {
  double start_m = 0, slope_m_per_s = 0;
};

[[nodiscard]] FrictionAxis stepWithFriction(const HandParameters& parameters, FrictionAxis state, PathAxis path,
                                            double force_N, double tick_s) noexcept;

}  // namespace palpate
