// SPDX-License-Identifier: Apache-2.0
// apps/stability/z_width.hpp: how stiff a surface may be until it shakes (Z-width; Colgate and Brown 1994), with
// everything that the linear limit leaves out: encoders, force and slew limits, a tool that may leave the surface, a
// curved surface, algorithm and effects.
//
// The hand presses the tool onto a ball, slides a way along it, and rests for kRestDecays times as long as the friction
// of hand and device alone needs to stop their mass, at least kRest_s. A surface is quiet if the tool then moves by at
// most kQuiet_m, or kQuietSteps encoder steps, along each axis. The stiffness is raised
// step by step until a surface is not quiet; the border is then bisected. Stiffer surfaces that happen to be quiet
// again do not count. Units: SI. Cost: some forty runs of 1.5 s: 0.1 s at 1 kHz.
#pragma once

#include "apps/stability/wall_run.hpp"

namespace palpate {

inline constexpr double kRest_s = 0.8, kRestDecays = 16;
inline constexpr double kQuiet_m = 10e-6;
inline constexpr double kQuietSteps = 2.5;
inline constexpr double kWidthPrecision = 0.02;
inline constexpr double kSoftestTried_N_per_m = 20, kStiffestTried_N_per_m = 1e6;

struct WidthQuestion {
  WallContact contact;  // its stiffness is what is asked for
  SimulatedDeviceParameters device;
  double rate_hz = 1000;
  std::string velocity = VelocityParameters{}.name;
  PassivityParameters passivity = {};
};

// Where the tool moved over the last part of the rest, along the axis where it moved most [m].
[[nodiscard]] double restlessness(const WidthQuestion& question, double stiffness_N_per_m, const WallVolume& volume);

struct Width {
  double stiffness_N_per_m = 0;  // the largest quiet one; 0: none is; kStiffestTried_N_per_m: all are
  double force_max_N = 0;        // largest force of the runs up to there
};
[[nodiscard]] Width width(const WidthQuestion& question, const WallVolume& volume);

}  // namespace palpate
