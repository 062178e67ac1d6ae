// SPDX-License-Identifier: Apache-2.0
// apps/stability/linear_limit.hpp: the largest stable stiffness by simulation: the real servo and the simulated device
// against a plane, to hold against the exact one (servo/stability/sampled_loop.hpp).
//
// The exact limit is one of small swings: a tool that leaves the surface, or that the surface would have to pull, is in
// another system. So the contact begins on a softer wall, and rests there. Then the servo goes over to stiffer ones, as
// it does when a user changes the stiffness, up to the wall in question. That leaves the tool in contact with a small
// swing, and what the swing does next is what counts. It is measured by the second difference of the tool's way, in
// which the slow motion of the hand does not show. The wall is stable if that is smaller in the last quarter of the
// watched time than in the one before, or that of a swing below kStill_m. The watched time is kWatch_s, kWatchTicks, or
// kWatchDecays times that in which the friction of hand and device alone stops their mass, whichever is longest: so
// much must pass until a small growth is seen. The limit is found between walls that are stable and walls that are not,
// without the exact one. Units: SI. Cost: some twenty runs of a few times the watched time: 0.3 s, for a mass of 10 kg
// 10 s.
#pragma once

#include <string>

#include "apps/stability/wall_run.hpp"

namespace palpate {

inline constexpr double kStill_m = 1e-9;  // depths are rounded to some 3e-10 m, as densities are floats
inline constexpr double kWatch_s = 0.4;
inline constexpr int kWatchTicks = 3000;
inline constexpr double kWatchDecays = 6;
inline constexpr double kLimitPrecision = 2e-3;

struct SimulatedLimit {
  SampledLoop loop;
  double damping_Ns_per_m = 0;
  std::string algorithm = "hri";
  int n = 1;
};

[[nodiscard]] bool settlesAt(const SimulatedLimit& what, double stiffness_N_per_m, const WallVolume& plane);

// The largest stiffness that settles [N/m]; 0 if no power of ten from 1 N/m on does.
[[nodiscard]] double simulatedLimit(const SimulatedLimit& what, const WallVolume& plane);

}  // namespace palpate
