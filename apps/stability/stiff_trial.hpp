// SPDX-License-Identifier: Apache-2.0
// apps/stability/stiff_trial.hpp: walls from soft to far too stiff, devices from light to heavy, servos from slow to
// fast: does the running servo end what shakes, leave what settles, and keep every force safe?
//
// A trial is drawn by chance. The hand presses the tool onto a plane and rests. What must come of it follows from the
// greatest eigenvalue of the sampled loop (servo/stability/sampled_loop.hpp), with what encoders make of the gain:
// their describing function lies between 0.8 and 4 / pi for swings of some steps. Between the two verdicts lies a
// border where the linear loop does not tell, since the tool may leave the surface. Units: SI. Cost of a trial:
// kTrial_s of ticks, 10 ms at 1 kHz.
#pragma once

#include <cstdint>
#include <vector>

#include "apps/stability/wall_run.hpp"

namespace palpate {

inline constexpr double kTrial_s = 12;

struct StiffTrial {
  SampledLoop loop;
  Wall wall;
  double resolution_m = 0;
  double press_m = 1e-3;
};

// K 10 to 1e6 N/m; B none, or up to 1.2 times what its limit is without a wall; mass of the device 10 g to 10 kg; ticks
// of 50 us to 10 ms; delay 0 to 4 ticks; hands of any kind. The same seed and number give the same trial.
[[nodiscard]] StiffTrial stiffTrial(std::uint64_t seed, std::uint64_t number);

enum class Expected { kSettles, kGrows, kBorder };
[[nodiscard]] Expected expectedOf(const StiffTrial& trial);  // by the eigenvalues

struct StiffOutcome {
  bool noticed = false;
  double notice_s = 0;         // from the first contact to the servo's decision [s]
  double end_force_N = 0;      // largest over the last tenth
  double end_swing_m = 0;      // way of the tool along the normal over the last tenth
  bool limited = false;        // before that a limit of force or slew acted, which the linear loop does not know
  double force_share_max = 0;  // largest force over the limit [-]
  double slew_share_max = 0;   // largest change over the slew limit [-]
  bool finite = true;          // every force, position and energy
};
[[nodiscard]] StiffOutcome play(const StiffTrial& trial, const WallVolume& plane);

// "settles", "grows", "border".
[[nodiscard]] const char* name(Expected expected) noexcept;

}  // namespace palpate
