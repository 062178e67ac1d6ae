// SPDX-License-Identifier: Apache-2.0
#include "servo/stability/sampled_loop.hpp"

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>

#include <Eigen/Eigenvalues>

#include "base/error.hpp"

namespace palpate {
namespace {

constexpr int kFirstForce = 4;  // index of F_{k-d} in the state; before it x, x', u, last x

// The largest value from `low` up to which `holds` is true, on a logarithmic grid and then bisected. 0 if it is false
// at `low`, `high` if it is true on the whole grid.
double lastOfRun(double low, double high, double precision, const std::function<bool(double)>& holds) {
  static const double kStep = std::pow(10.0, 1.0 / 16);
  if (!holds(low)) return 0;
  double good = low, bad = low * kStep;
  while (bad < high && holds(bad)) {
    good = bad;
    bad *= kStep;
  }
  if (bad >= high) return high;
  while (bad > good * (1 + precision)) {
    const double middle = std::sqrt(good * bad);
    (holds(middle) ? good : bad) = middle;
  }
  return good;
}

}  // namespace

Eigen::MatrixXd transitionMatrix(const SampledLoop& loop, const Wall& wall) {
  checkSetting(loop.delay_ticks >= 0, "device delay", loop.delay_ticks, "give 0 ticks or more");
  const double tick_s = 1 / loop.rate_hz;
  const HandDynamics dynamics(loop.hand, tick_s);
  const HandDynamics::Transition& step = dynamics.transition();
  const double gain = loop.velocity_cutoff_hz > 0 ? -std::expm1(-2 * M_PI * loop.velocity_cutoff_hz * tick_s) : 1;
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

// In SI units a force may be 1e8 times a position, and rounding would move eigenvalues by as much as matters here. So
// the state is scaled to lengths: the way in a tick at a velocity, and the way that a force moves the mass in a tick.
std::complex<double> greatestEigenvalue(const SampledLoop& loop, const Wall& wall) {
  const double tick_s = 1 / loop.rate_hz, mass_kg = loop.hand.hand_mass_kg + loop.hand.device_mass_kg;
  Eigen::MatrixXd system = transitionMatrix(loop, wall);
  Eigen::VectorXd to_lengths = Eigen::VectorXd::Constant(system.rows(), tick_s * tick_s / mass_kg);
  to_lengths.head<kFirstForce>() << 1, tick_s, tick_s, 1;
  system = to_lengths.asDiagonal() * system * to_lengths.cwiseInverse().asDiagonal();
  const Eigen::VectorXcd values = system.eigenvalues();
  return *std::max_element(values.begin(), values.end(),
                           [](const auto& a, const auto& b) { return std::abs(a) < std::abs(b); });
}

bool isStable(const SampledLoop& loop, const Wall& wall) {
  return std::abs(greatestEigenvalue(loop, wall)) < 1;
}

double stiffnessBound(const SampledLoop& loop, double damping_Ns_per_m, double precision) {
  return lastOfRun(kSoftest_N_per_m, kStiffest_N_per_m, precision, [&](double stiffness) {
    return isStable(loop, {stiffness, damping_Ns_per_m});
  });
}

double dampingBound(const SampledLoop& loop, double stiffness_N_per_m, double precision) {
  const auto stable = [&](double damping) { return isStable(loop, {stiffness_N_per_m, damping}); };
  double from = kLeastDamping_Ns_per_m;
  while (from < kMostDamping_Ns_per_m && !stable(from)) from *= 1.1;
  return from < kMostDamping_Ns_per_m ? lastOfRun(from, kMostDamping_Ns_per_m, precision, stable) : 0;
}

int delayBound(const SampledLoop& loop, const Wall& wall, int most) {
  SampledLoop late = loop;
  for (late.delay_ticks = 0; late.delay_ticks <= most; ++late.delay_ticks) {
    if (!isStable(late, wall)) return late.delay_ticks - 1;
  }
  return most;
}

// A longer tick is never better: searched from the shortest one on.
double rateBound(const SampledLoop& loop, const Wall& wall, double precision) {
  SampledLoop other = loop;
  const double longest_s = lastOfRun(1 / kHighestRate_hz, 1.0, precision, [&](double tick_s) {
    other.rate_hz = 1 / tick_s;
    return isStable(other, wall);
  });
  return longest_s > 0 ? 1 / longest_s : std::numeric_limits<double>::infinity();
}

}  // namespace palpate
