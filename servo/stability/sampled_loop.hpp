// SPDX-License-Identifier: Apache-2.0
// servo/stability/sampled_loop.hpp: a wall in a sampled loop, as a linear system, and the exact limits of its
// stability.
//
// One axis, along the wall's normal, with the tool in contact all the time. In each tick k the servo reads the position
// x_k and estimates the velocity as servo/loop/velocity_filter.hpp does:
//   u_k = u_{k-1} + a ((x_k - x_{k-1}) / T - u_{k-1}),  a = 1 - exp(-2 pi f_c T).
// Then it sets F_k = -K x_k - B u_k. The device holds F_{k-d} until the next tick. Device and hand are one mass with
// damping and the hand's spring (servo/devices/hand_dynamics.hpp), which the matrix exponential steps exactly. So
//   s_{k+1} = M s_k,  s = (x_k, x'_k, u_{k-1}, x_{k-1}, F_{k-d} .. F_{k-1}),
// and the contact settles if and only if every eigenvalue of M lies inside the unit circle. Of the passivity bounds in
// passivity_bounds.hpp each is on the safe side of that.
//
// What the model leaves out: encoders that round, Coulomb friction, limits of the force, and leaving the surface.
// Units: SI. Thread: any. The functions allocate. Cost: isStable() counts the eigenvalues inside without computing them
// (late_feedback.hpp), in some microseconds whatever d is; a bound asks it some hundred times. greatestEigenvalue() is
// an eigenvalue problem of order 4 + d: some 10 us for d = 0, seconds for d = 1000. settlesSoon() is one of order 20 at
// most.
#pragma once

#include <complex>
#include <functional>

#include <Eigen/Core>

#include "servo/devices/hand_dynamics.hpp"

namespace palpate {

struct SampledLoop {
  HandParameters hand = {};         // and device
  double rate_hz = 1000;            // 1 / T
  int delay_ticks = 0;              // d, 0 or more
  double velocity_cutoff_hz = 200;  // f_c; 0: no low-pass, a = 1
};

struct Wall {
  double stiffness_N_per_m = 0;  // K
  double damping_Ns_per_m = 0;   // B
};

// M above. As all that follow it throws Error(kBadInput) as HandDynamics does, for a negative delay, and for a wall
// that is not finite.
[[nodiscard]] Eigen::MatrixXd transitionMatrix(const SampledLoop& loop, const Wall& wall);

// The eigenvalue of M that is farthest from zero. Its size is the factor by which a swing grows in a tick, its argument
// the angle by which the swing turns.
[[nodiscard]] std::complex<double> greatestEigenvalue(const SampledLoop& loop, const Wall& wall);

[[nodiscard]] bool isStable(const SampledLoop& loop, const Wall& wall);

// The stiffness up to which every wall of damping B is stable [N/m]; 0 if the softest one, kSoftest_N_per_m, is not.
// kStiffest_N_per_m if none is unstable. Found on a grid of 16 values a decade and bisected to `precision` of itself.
inline constexpr double kSoftest_N_per_m = 1e-2;
inline constexpr double kStiffest_N_per_m = 1e9;
inline constexpr double kBoundPrecision = 1e-3;
[[nodiscard]] double stiffnessBound(const SampledLoop& loop, double damping_Ns_per_m,
                                    double precision = kBoundPrecision);

// Whether the contact comes to rest soon: this, not stability alone, is what a wall must have to be given to a hand. A
// swing near the border of stability goes on for seconds, and what the model leaves out may feed it. So every mode that
// swings must lose
// - kLossAPeriod of itself in each period, or in each round of a delay that is longer. The swings that answer a surface
//   that moves by a are then at most Q a, with Q = pi / -ln(1 - kLossAPeriod) = 29.8. SwingWatch takes swings of more
//   than kAnswered = 40 times what asked for them, and swings that lose less than 5.6 % a period, for unstable;
// - nine tenths of itself within kLongestRing_s, or in a round of a delay that takes longer, however slow it is.
// Besides,
// - a wall that is kGainMargin times as stiff, with the same damping or with as much more, must be stable: a tool that
//   lands, leaves and lands again, a plane that is kept and voxels make it so for a while;
// - the damping may be usefulDamping() at most: a tool that lands meets all of it at once, and what is stable but too
//   late throws the tool off again.
// No more is asked than half of the loss of hand and device without a wall, in a period and in a second: a wall cannot
// damp what they do not. With a delay of more than kMostExactDelay ticks a wall settles if one that is three times as
// stiff and damped is stable: its modes are as many as the delay has ticks.
inline constexpr double kLossAPeriod = 0.1;
inline constexpr double kGainMargin = 1.3;
inline constexpr double kLongestRing_s = 2;
inline constexpr int kMostExactDelay = 16;
[[nodiscard]] double usefulDamping(const SampledLoop& loop);  // brakingDamping() of this loop [N s/m]
[[nodiscard]] bool settlesSoon(const SampledLoop& loop, const Wall& wall);

// The stiffness up to which walls of damping B settle soon [N/m]; 0 if the softest one does not. At most
// stiffnessBound(), from which it is searched downwards.
[[nodiscard]] double settlingStiffness(const SampledLoop& loop, double damping_Ns_per_m,
                                       double precision = kBoundPrecision);

// The force by which the wall answers in one tick to an encoder that goes on by a step of `resolution_m` [N]: the
// position is a step farther, and the velocity's filter takes it for one of a Delta / T: (K + B a / T) Delta.
[[nodiscard]] double forceOfAStep(const SampledLoop& loop, const Wall& wall, double resolution_m);

// The damping up to which every wall of stiffness K is stable [N s/m], in the same way from kLeastDamping_Ns_per_m to
// kMostDamping_Ns_per_m. If K is unstable without damping, the range begins where damping makes it stable; 0 if none
// does.
inline constexpr double kLeastDamping_Ns_per_m = 1e-4;
inline constexpr double kMostDamping_Ns_per_m = 1e5;
[[nodiscard]] double dampingBound(const SampledLoop& loop, double stiffness_N_per_m,
                                  double precision = kBoundPrecision);

// The largest delay of the force with which the wall is stable, at most `most` [tick]; -1 if none is, 0 included.
[[nodiscard]] int delayBound(const SampledLoop& loop, const Wall& wall, int most = 100);

// The rate from which on the wall is stable, up to kHighestRate_hz [Hz]; infinity if it is unstable at that rate.
inline constexpr double kHighestRate_hz = 20000;
[[nodiscard]] double rateBound(const SampledLoop& loop, const Wall& wall, double precision = kBoundPrecision);
// The same for anything that a longer tick never makes better.
[[nodiscard]] double leastRate(const std::function<bool(double rate_hz)>& holds, double precision = kBoundPrecision);

}  // namespace palpate
