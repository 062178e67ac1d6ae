// SPDX-License-Identifier: Apache-2.0
#include "servo/stability/sampled_loop.hpp"

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <optional>

#include <Eigen/Eigenvalues>

#include "base/error.hpp"
#include "servo/stability/late_feedback.hpp"

namespace palpate {
namespace {

constexpr int kFirstForce = 4;  // index of F_{k-d} in the state; before it x, x', u, last x

using Holds = std::function<bool(double)>;

// Below the border that is looked for `holds` is true, above it false. Goes from `from` towards `end` on a logarithmic
// grid, upwards from where it is true or downwards from where it is false, until it changes, and bisects there. Returns
// the largest value found for which it is true; none if it does not change before `end`.
std::optional<double> borderFrom(double from, double end, double precision, const Holds& holds) {
  const bool upwards = end > from;
  const double step = std::pow(10.0, (upwards ? 1 : -1) / 16.0);
  double last = from;
  for (double next = from * step; upwards ? next < end : next > end; next *= step) {
    if (holds(next) == upwards) {
      last = next;
      continue;
    }
    double good = upwards ? last : next, bad = upwards ? next : last;
    while (bad > good * (1 + precision)) {
      const double middle = std::sqrt(good * bad);
      (holds(middle) ? good : bad) = middle;
    }
    return good;
  }
  return std::nullopt;
}

// The largest value from `low` up to which `holds` is true. 0 if it is false at `low`, `high` if it is true on the
// whole grid.
double lastOfRun(double low, double high, double precision, const Holds& holds) {
  return holds(low) ? borderFrom(low, high, precision, holds).value_or(high) : 0;
}

// a of the velocity's filter.
double filterGain(const SampledLoop& loop) {
  return loop.velocity_cutoff_hz > 0 ? -std::expm1(-2 * M_PI * loop.velocity_cutoff_hz / loop.rate_hz) : 1;
}

void check(const SampledLoop& loop, const Wall& wall) {
  checkSetting(loop.delay_ticks >= 0, "device delay", loop.delay_ticks, "give 0 ticks or more");
  checkSetting(std::isfinite(wall.stiffness_N_per_m), "stiffness", wall.stiffness_N_per_m, "give a number");
  checkSetting(std::isfinite(wall.damping_Ns_per_m), "damping", wall.damping_Ns_per_m, "give a number");
}

// The characteristic polynomial of M but for a factor z: with the mass's step x = Phi x + g F,
//   z^d det(z I - Phi) (z - 1 + a) + (g_x (z - Phi_vv) + Phi_xv g_v) (K (z - 1 + a) + B a (z - 1) / T).
LateFeedback characteristic(const SampledLoop& loop, const Wall& wall) {
  check(loop, wall);
  const double tick_s = 1 / loop.rate_hz, gain = filterGain(loop);
  const HandDynamics dynamics(loop.hand, tick_s);
  const HandDynamics::Transition& step = dynamics.transition();
  const double x_lost = 1 - step(0, 0), v_lost = 1 - step(1, 1), x_of_f = step(0, 4), v_of_f = step(1, 4);
  const bool is_held = loop.hand.hand_stiffness_N_per_m > 0;  // if not, z = 1 is a root, exactly
  const double held = is_held ? x_lost * v_lost - step(0, 1) * step(1, 0) : 0;
  return {.open = {{held, x_lost + v_lost, 1}, {gain, 1}},
          .feedback = {{x_of_f * v_lost + step(0, 1) * v_of_f, x_of_f},
                       {wall.stiffness_N_per_m * gain, wall.stiffness_N_per_m + wall.damping_Ns_per_m * gain / tick_s}},
          .delay_ticks = loop.delay_ticks};
}

}  // namespace

Eigen::MatrixXd transitionMatrix(const SampledLoop& loop, const Wall& wall) {
  check(loop, wall);
  const double tick_s = 1 / loop.rate_hz, gain = filterGain(loop);
  const HandDynamics dynamics(loop.hand, tick_s);
  const HandDynamics::Transition& step = dynamics.transition();
  const Eigen::Index size = kFirstForce + loop.delay_ticks;

  Eigen::RowVectorXd velocity = Eigen::RowVectorXd::Zero(size);  // u_k of the state
  velocity[0] = gain / tick_s;
  velocity[2] = 1 - gain;
  velocity[3] = -gain / tick_s;
  Eigen::RowVectorXd force = -wall.damping_Ns_per_m * velocity;  // F_k
  force[0] -= wall.stiffness_N_per_m;
  const Eigen::RowVectorXd acting =
      loop.delay_ticks > 0 ? Eigen::RowVectorXd(Eigen::RowVectorXd::Unit(size, kFirstForce)) : force;

  Eigen::MatrixXd system = Eigen::MatrixXd::Zero(size, size);
  for (int row = 0; row < 2; ++row) {
    system.row(row) = step(row, 4) * acting;
    system(row, 0) += step(row, 0);
    system(row, 1) += step(row, 1);
  }
  system.row(2) = velocity;
  system(3, 0) = 1;
  for (Eigen::Index i = kFirstForce; i + 1 < size; ++i) system(i, i + 1) = 1;
  if (loop.delay_ticks > 0) system.row(size - 1) = force;
  return system;
}

namespace {

// In SI units a force may be 1e8 times a position, and rounding would move eigenvalues by as much as matters here. So
// the state is scaled to lengths: the way in a tick at a velocity, and the way that a force moves the mass in a tick.
Eigen::VectorXcd eigenvalues(const SampledLoop& loop, const Wall& wall) {
  const double tick_s = 1 / loop.rate_hz, mass_kg = loop.hand.hand_mass_kg + loop.hand.device_mass_kg;
  Eigen::MatrixXd system = transitionMatrix(loop, wall);
  Eigen::VectorXd to_lengths = Eigen::VectorXd::Constant(system.rows(), tick_s * tick_s / mass_kg);
  to_lengths.head<kFirstForce>() << 1, tick_s, tick_s, 1;
  system = to_lengths.asDiagonal() * system * to_lengths.cwiseInverse().asDiagonal();
  return system.eigenvalues();
}

// f and its derivative, at z = 1 + zeta.
struct Slope {
  std::complex<double> value, derivative;
};

Slope slopeOf(const std::vector<LoopFactor>& factors, const std::complex<double>& zeta) {
  Slope all{1, 0};
  for (const LoopFactor& f : factors) {
    const std::complex<double> value = f.constant + zeta * (f.linear + zeta * f.square);
    all.derivative = all.derivative * value + all.value * (f.linear + 2.0 * f.square * zeta);
    all.value *= value;
  }
  return all;
}

// Newton's steps on the characteristic equation, whose form in z - 1 does not cancel where slow modes are.
std::complex<double> polished(const LateFeedback& loop, std::complex<double> z) {
  constexpr int kSteps = 3;
  for (int i = 0; i < kSteps; ++i) {
    const Slope open = slopeOf(loop.open, z - 1.0), feedback = slopeOf(loop.feedback, z - 1.0);
    const std::complex<double> late = std::pow(z, loop.delay_ticks);
    const double d = loop.delay_ticks;
    const std::complex<double> value = late * open.value + feedback.value;
    const std::complex<double> slope = late * (open.derivative + d * open.value / z) + feedback.derivative;
    const std::complex<double> step = value / slope;
    if (!(std::abs(step) < 1e-3)) break;  // not the root that was meant, or several together
    z -= step;
  }
  return z;
}

// What the modes must lose, as the logarithm of what is left: in a period, and in a second.
struct Loss {
  double a_period = -std::log1p(-kLossAPeriod), a_second = std::log(10.0) / kLongestRing_s;
};

Loss lossOf(const HandParameters& hand) {
  const double mass_kg = hand.hand_mass_kg + hand.device_mass_kg;
  const double own = (hand.hand_damping_Ns_per_m + hand.device_damping_Ns_per_m) / (2 * mass_kg);  // [1/s]
  const double turns_squared = hand.hand_stiffness_N_per_m / mass_kg - own * own;
  Loss loss;
  loss.a_second = std::min(loss.a_second, own / 2);
  if (turns_squared > 0) loss.a_period = std::min(loss.a_period, M_PI * own / std::sqrt(turns_squared));
  return loss;
}

bool losesEnough(const std::complex<double>& z, const SampledLoop& loop, const Loss& least) {
  constexpr double kGone = 0.05;     // of such a mode nothing is left after three ticks
  constexpr double kNoSwing = 1e-9;  // [rad a tick]
  const double size = std::abs(z), turn = std::abs(std::arg(z));
  if (size < kGone) return true;
  const double lost = -std::log(size);  // in a tick
  if (turn < kNoSwing) return lost > 0;
  // A force that is later than a period cannot damp within that period: a round of the delay counts instead. So it does
  // for the loss in a second where a round takes longer than kLongestRing_s, as it may below 9 Hz.
  const double round = loop.delay_ticks + 1;
  return lost * std::max(2 * M_PI / turn, round) >= least.a_period &&
         lost * std::max(loop.rate_hz, round / kLongestRing_s) >= least.a_second;
}

}  // namespace

std::complex<double> greatestEigenvalue(const SampledLoop& loop, const Wall& wall) {
  const Eigen::VectorXcd values = eigenvalues(loop, wall);
  return *std::max_element(values.begin(), values.end(),
                           [](const auto& a, const auto& b) { return std::abs(a) < std::abs(b); });
}

bool isStable(const SampledLoop& loop, const Wall& wall) {
  return allInside(characteristic(loop, wall));
}

double stiffnessBound(const SampledLoop& loop, double damping_Ns_per_m, double precision) {
  return lastOfRun(kSoftest_N_per_m, kStiffest_N_per_m, precision, [&](double stiffness) {
    return isStable(loop, {stiffness, damping_Ns_per_m});
  });
}

double usefulDamping(const SampledLoop& loop) {
  return brakingDamping(loop.hand, loop.rate_hz, loop.delay_ticks, loop.velocity_cutoff_hz);
}

bool settlesSoon(const SampledLoop& loop, const Wall& wall) {
  if (wall.damping_Ns_per_m > usefulDamping(loop)) return false;
  const double stiffer = kGainMargin * wall.stiffness_N_per_m;
  for (const double damping : {wall.damping_Ns_per_m, kGainMargin * wall.damping_Ns_per_m})
    if (!isStable(loop, {stiffer, damping})) return false;
  if (loop.delay_ticks > kMostExactDelay)
    return isStable(loop, {3 * wall.stiffness_N_per_m, 3 * wall.damping_Ns_per_m}) && isStable(loop, wall);
  const LateFeedback form = characteristic(loop, wall);
  if (!allInside(form)) return false;
  const Loss least = lossOf(loop.hand);
  const Eigen::VectorXcd values = eigenvalues(loop, wall);
  return std::all_of(values.begin(), values.end(), [&](const std::complex<double>& z) {
    return losesEnough(std::abs(z) > 0.5 ? polished(form, z) : z, loop, least);
  });
}

double settlingStiffness(const SampledLoop& loop, double damping_Ns_per_m, double precision) {
  const auto settles = [&](double stiffness) { return settlesSoon(loop, {stiffness, damping_Ns_per_m}); };
  const double stable = stiffnessBound(loop, damping_Ns_per_m, precision);
  if (stable == 0 || settles(stable)) return stable;
  return borderFrom(stable, kSoftest_N_per_m, precision, settles).value_or(0);
}

double forceOfAStep(const SampledLoop& loop, const Wall& wall, double resolution_m) {
  return (wall.stiffness_N_per_m + wall.damping_Ns_per_m * filterGain(loop) * loop.rate_hz) * resolution_m;
}

double dampingBound(const SampledLoop& loop, double stiffness_N_per_m, double precision) {
  const auto stable = [&](double damping) { return isStable(loop, {stiffness_N_per_m, damping}); };
  double from = kLeastDamping_Ns_per_m;
  while (from < kMostDamping_Ns_per_m && !stable(from)) from *= 1.1;
  return from < kMostDamping_Ns_per_m ? lastOfRun(from, kMostDamping_Ns_per_m, precision, stable) : 0;
}

int delayBound(const SampledLoop& loop, const Wall& wall, int most) {
  LateFeedback late = characteristic(loop, wall);
  for (late.delay_ticks = 0; late.delay_ticks <= most; ++late.delay_ticks) {
    if (!allInside(late)) return late.delay_ticks - 1;
  }
  return most;
}

double leastRate(const std::function<bool(double)>& holds, double precision) {
  const double longest_s =
      lastOfRun(1 / kHighestRate_hz, 1.0, precision, [&](double tick_s) { return holds(1 / tick_s); });
  return longest_s > 0 ? 1 / longest_s : std::numeric_limits<double>::infinity();
}

double rateBound(const SampledLoop& loop, const Wall& wall, double precision) {
  SampledLoop other = loop;
  const auto stable = [&](double rate_hz) {
    other.rate_hz = rate_hz;
    return isStable(other, wall);
  };
  return leastRate(stable, precision);
}

}  // namespace palpate
