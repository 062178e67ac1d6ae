// SPDX-License-Identifier: Apache-2.0
// The exact limits of the sampled loop, against a limit in closed form, against the loop played tick by tick with an
// integrator of its own, and against each other.
#include "servo/stability/sampled_loop.hpp"

#include <cmath>
#include <deque>
#include <limits>
#include <random>

#include <gtest/gtest.h>

#include "base/error.hpp"

namespace palpate {
namespace sampled_loop_test {

class Dice {
 public:
  explicit Dice(unsigned seed) : random_(seed) {}
  double between(double low, double high) { return std::uniform_real_distribution<double>(low, high)(random_); }
  double decades(double low, double high) { return std::exp(between(std::log(low), std::log(high))); }
  int upTo(int most) { return std::uniform_int_distribution<int>(0, most)(random_); }

 private:
  std::mt19937 random_;
};

// Any loop of 10 g to 10 kg, a tick of 50 us to 10 ms, a delay of up to five ticks, hands from none to a stiff grip.
SampledLoop anyLoop(Dice& dice) {
  SampledLoop loop;
  loop.hand = {.hand_mass_kg = dice.upTo(3) == 0 ? 0 : dice.decades(0.01, 1),
               .hand_damping_Ns_per_m = dice.upTo(3) == 0 ? 0 : dice.decades(0.1, 30),
               .hand_stiffness_N_per_m = dice.upTo(3) == 0 ? 0 : dice.decades(10, 3000),
               .device_mass_kg = dice.decades(0.01, 10),
               .device_damping_Ns_per_m = dice.decades(0.01, 20)};
  loop.rate_hz = dice.decades(100, 20000);
  loop.delay_ticks = dice.upTo(5);
  loop.velocity_cutoff_hz = dice.upTo(3) == 0 ? 0 : dice.decades(10, 2000);
  return loop;
}

// A mass m with damping b against the ground, no filter, no delay, no damping of the wall: two states. With
// e = exp(-b T / m) the step is x+ = x + m (1 - e) / b v + ..., and Jury's criterion for order two limits K twice.
double boundOfBareMass(double mass_kg, double damping_Ns_per_m, double tick_s) {
  const double m = mass_kg, b = damping_Ns_per_m;
  const double e = std::exp(-b * tick_s / m), lost = -std::expm1(-b * tick_s / m);
  const double x_of_v = lost * m / b, x_of_f = (tick_s - x_of_v) / b, v_of_f = lost / b;
  const double by_determinant = lost / (x_of_v * v_of_f - e * x_of_f);
  const double curvature = x_of_f - (x_of_v * v_of_f - e * x_of_f);  // trace > -(1 + determinant)
  const double by_trace = curvature > 0 ? 2 * (1 + e) / curvature : std::numeric_limits<double>::infinity();
  return std::min(by_determinant, by_trace);
}

TEST(SampledLoop, TheBoundOfABareMassIsThatOfItsCharacteristicEquation) {
  Dice dice(1);
  for (int i = 0; i < 300; ++i) {
    SampledLoop loop;
    loop.hand = {0, 0, 0, dice.decades(0.01, 10), dice.decades(0.01, 20)};
    loop.rate_hz = dice.decades(100, 20000);
    loop.velocity_cutoff_hz = 0;
    const double exact = boundOfBareMass(loop.hand.device_mass_kg, loop.hand.device_damping_Ns_per_m, 1 / loop.rate_hz);
    EXPECT_NEAR(stiffnessBound(loop, 0) / exact, 1, 1.001 * kBoundPrecision) << i;
  }
}

// Colgate and Schenkel's 2 b / T is its limit for short ticks: the relative difference is of the order b T / m.
TEST(SampledLoop, ForShortTicksABareMassBearsTwoDampingsATick) {
  SampledLoop loop;
  loop.hand = {0, 0, 0, 1, 0.5};
  loop.rate_hz = 10000;
  EXPECT_NEAR(stiffnessBound(loop, 0, 1e-6) / (2 * 0.5 * 10000), 1, 0.5e-4);
  // Longer by half a tick of delay: b > K (T / 2 + T d).
  loop.delay_ticks = 2;
  EXPECT_NEAR(stiffnessBound(loop, 0, 1e-6) / (0.5 * 10000 / 2.5), 1, 5e-4);
}

// The loop tick by tick, as the servo runs it; the device by the classical Runge-Kutta method in `kSteps` steps a tick.
class Played {
 public:
  Played(const SampledLoop& loop, const Wall& wall)
      : loop_(loop), wall_(wall), under_way_(static_cast<std::size_t>(loop.delay_ticks), 0) {}

  // Mean growth of the state's logarithm a tick, over the second half of the run.
  double growth() {
    constexpr int kTicks = 6000;
    double log_size = 0, half = 0;
    for (int k = 0; k < kTicks; ++k) {
      tick();
      const double scale =
          std::abs(x_) + std::abs(v_) / loop_.rate_hz + std::abs(u_) / loop_.rate_hz + std::abs(last_x_) + forces();
      if (k % 100 != 99) continue;
      log_size += std::log(scale);
      shrink(scale);
      if (k == kTicks / 2 - 1) half = log_size;
    }
    return (log_size - half) / (kTicks / 2);
  }

 private:
  static constexpr int kSteps = 40;

  [[nodiscard]] double forces() const {
    double sum = 0;
    for (const double f : under_way_) sum += std::abs(f) / (1 + wall_.stiffness_N_per_m);
    return sum;
  }
  void shrink(double scale) {
    for (double* one : {&x_, &v_, &u_, &last_x_}) *one /= scale;
    for (double& f : under_way_) f /= scale;
  }
  void tick() {
    const double tick_s = 1 / loop_.rate_hz;
    const double keep = loop_.velocity_cutoff_hz > 0 ? std::exp(-2 * M_PI * loop_.velocity_cutoff_hz * tick_s) : 0;
    u_ = keep * u_ + (1 - keep) * (x_ - last_x_) / tick_s;
    last_x_ = x_;
    under_way_.push_back(-wall_.stiffness_N_per_m * x_ - wall_.damping_Ns_per_m * u_);
    const double force = under_way_.front();
    under_way_.pop_front();
    const HandParameters& p = loop_.hand;
    const auto acceleration = [&](double x, double v) {
      return (force - p.hand_stiffness_N_per_m * x - (p.hand_damping_Ns_per_m + p.device_damping_Ns_per_m) * v) /
             (p.hand_mass_kg + p.device_mass_kg);
    };
    const double h = tick_s / kSteps;
    for (int i = 0; i < kSteps; ++i) {
      const double k1x = v_, k1v = acceleration(x_, v_);
      const double k2x = v_ + h / 2 * k1v, k2v = acceleration(x_ + h / 2 * k1x, v_ + h / 2 * k1v);
      const double k3x = v_ + h / 2 * k2v, k3v = acceleration(x_ + h / 2 * k2x, v_ + h / 2 * k2v);
      const double k4x = v_ + h * k3v, k4v = acceleration(x_ + h * k3x, v_ + h * k3v);
      x_ += h / 6 * (k1x + 2 * k2x + 2 * k3x + k4x);
      v_ += h / 6 * (k1v + 2 * k2v + 2 * k3v + k4v);
    }
  }

  SampledLoop loop_;
  Wall wall_;
  double x_ = 1, v_ = 0, u_ = 0, last_x_ = 1;
  std::deque<double> under_way_;
};

// A mean over 3000 ticks of a swing whose phase at the ends is unknown is off by some log(10) / 3000 = 8e-4 at worst; a
// pair of eigenvalues of nearly one size beats for as long. So only growth beyond 3e-3 a tick is compared.
TEST(SampledLoop, TheGreatestEigenvalueIsTheGrowthOfThePlayedLoop) {
  Dice dice(2);
  int grown = 0, settled = 0;
  for (int i = 0; i < 150; ++i) {
    const SampledLoop loop = anyLoop(dice);
    const Wall wall = {dice.decades(1, 1e5), dice.upTo(2) == 0 ? 0 : dice.decades(0.01, 100)};
    const double exact = std::log(std::abs(greatestEigenvalue(loop, wall)));
    const double played = Played(loop, wall).growth();
    EXPECT_NEAR(played, exact, 3e-3 + 1e-3 * std::abs(exact))
        << i << " K " << wall.stiffness_N_per_m << " B " << wall.damping_Ns_per_m;
    (exact > 3e-3 ? grown : settled) += 1;
  }
  EXPECT_GT(grown, 30);
  EXPECT_GT(settled, 30);
}

// Both from one system, in two ways. The eigenvalues are those of a matrix that differs by its order times epsilon of
// its largest entries, the way in a tick by the wall's force; four of them may be slow and lie together near z = 1,
// where they move by the fourth root of that. Nearer to the circle nothing is said.
TEST(SampledLoop, IsStableWhereNoEigenvalueGrows) {
  Dice dice(5);
  int stable = 0, unstable = 0;
  for (int i = 0; i < 2000; ++i) {
    SampledLoop loop = anyLoop(dice);
    loop.delay_ticks = dice.upTo(4) == 0 ? dice.upTo(60) : dice.upTo(6);
    const Wall wall = {dice.upTo(9) == 0 ? 0 : dice.decades(1e-2, 1e6),
                       dice.upTo(2) == 0 ? 0 : dice.decades(1e-3, 1e3)};
    const double size = std::abs(greatestEigenvalue(loop, wall));
    const double tick_s = 1 / loop.rate_hz, mass_kg = loop.hand.hand_mass_kg + loop.hand.device_mass_kg;
    const double entries = 1 + (wall.stiffness_N_per_m * tick_s + wall.damping_Ns_per_m) * tick_s / mass_kg;
    const double rounding = (4 + loop.delay_ticks) * std::numeric_limits<double>::epsilon() * entries;
    if (std::abs(size - 1) < std::pow(rounding, 0.25)) continue;
    EXPECT_EQ(isStable(loop, wall), size < 1)
        << i << " K " << wall.stiffness_N_per_m << " B " << wall.damping_Ns_per_m << " d " << loop.delay_ticks;
    (size < 1 ? stable : unstable) += 1;
  }
  EXPECT_GT(stable, 300);
  EXPECT_GT(unstable, 300);
}

// A mass m with much damping b is slow: b x' = -K x(t - L) settles for K / b L < pi / 2. L is the delay, the half tick
// for which a force is held, and the mass's m / b. What is left out is (w m / b)^2 / 2 with w = pi / 2 / L, less than
// twice the square of m / b / L, and with a tick of m / b, too, less than that for its hold; and the bound's precision.
TEST(SampledLoop, AVeryLateForceHasTheBoundOfADelayedIntegrator) {
  for (const int delay : {100, 1000, 10000}) {
    SampledLoop loop;
    loop.hand = {0, 0, 0, 0.01, 10};
    loop.delay_ticks = delay;
    const double lag_s = 0.01 / 10, late_s = (delay + 0.5) / loop.rate_hz + lag_s;
    EXPECT_NEAR(stiffnessBound(loop, 0, 1e-6) / (M_PI / 2 * 10 / late_s), 1, 4 * lag_s * lag_s / late_s / late_s + 1e-6)
        << delay;
  }
}

TEST(SampledLoop, BelowItsBoundEveryStiffnessIsStableAndAboveItIsNot) {
  Dice dice(3);
  int bounded = 0;
  for (int i = 0; i < 200; ++i) {
    const SampledLoop loop = anyLoop(dice);
    const double damping = dice.upTo(2) == 0 ? 0 : dice.decades(0.01, 50);
    const double bound = stiffnessBound(loop, damping);
    if (bound < kSoftest_N_per_m || bound >= kStiffest_N_per_m) continue;
    ++bounded;
    for (int k = 0; k < 20; ++k)
      EXPECT_TRUE(isStable(loop, {dice.decades(kSoftest_N_per_m, bound), damping})) << i << " bound " << bound;
    EXPECT_FALSE(isStable(loop, {bound * (1 + 1.01 * kBoundPrecision), damping})) << i;
  }
  EXPECT_GT(bounded, 120);
}

// A device of 20 g to 0.5 kg in a hand whose stiffness and damping grow together, as those of typical_hands.hpp do.
// Without a wall it loses so much of a swing that half of it is what is asked for.
SampledLoop heldLoop(Dice& dice) {
  SampledLoop loop;
  const double damping = dice.decades(1, 20);
  loop.hand = {.hand_mass_kg = dice.decades(0.03, 0.3),
               .hand_damping_Ns_per_m = damping,
               .hand_stiffness_N_per_m = damping * dice.decades(10, 30),
               .device_mass_kg = dice.decades(0.02, 0.5),
               .device_damping_Ns_per_m = dice.decades(0.01, 5)};
  loop.rate_hz = dice.decades(500, 5000);
  loop.delay_ticks = dice.upTo(8);
  return loop;
}

// By the eigenvalues alone.
TEST(SampledLoop, WhatSettlesSoonLosesSoMuchOfEachSwing) {
  Dice dice(7);
  int checked = 0;
  for (int i = 0; i < 150; ++i) {
    const SampledLoop loop = heldLoop(dice);
    const double damping = dice.upTo(2) == 0 ? 0 : dice.between(0, 1) * usefulDamping(loop);
    const double most = settlingStiffness(loop, damping);
    ASSERT_GT(most, 0) << i;
    ASSERT_LE(most, stiffnessBound(loop, damping)) << i;
    EXPECT_TRUE(settlesSoon(loop, {0.999 * most, damping})) << i;
    EXPECT_TRUE(isStable(loop, {1.298 * most, damping}) && isStable(loop, {1.298 * most, 1.298 * damping})) << i;
    EXPECT_EQ(settlingStiffness(loop, 1.001 * usefulDamping(loop)), 0) << i;
    for (int k = 0; k < 10; ++k) EXPECT_TRUE(settlesSoon(loop, {dice.decades(1, most), damping})) << i;
    const std::complex<double> z = greatestEigenvalue(loop, {most, damping});
    const double turn = std::abs(std::arg(z));
    if (turn < 1e-6) continue;  // the slowest mode does not swing
    ++checked;
    const double period = std::max(2 * M_PI / turn, loop.delay_ticks + 1.0);
    EXPECT_GE(1 - std::pow(std::abs(z), period), 0.999 * kLossAPeriod) << i;
  }
  EXPECT_GT(checked, 50);
}

// By an integrator of its own, with the period that the eigenvalue has: kLossAPeriod is lost in each. Between place and
// way in a tick lies a factor of period / 2 pi, so the mean growth over 3000 ticks wavers by that much with a swing's
// phase.
TEST(SampledLoop, WhatSettlesSoonIsSeenToSettle) {
  Dice dice(8);
  int checked = 0;
  for (int i = 0; i < 60; ++i) {
    const SampledLoop loop = heldLoop(dice);
    const double damping = dice.upTo(2) == 0 ? 0 : dice.between(0, 1) * usefulDamping(loop);
    const double most = settlingStiffness(loop, damping);
    const double turn = std::abs(std::arg(greatestEigenvalue(loop, {most, damping})));
    if (turn < 1e-6) continue;
    const double period = std::max(2 * M_PI / turn, loop.delay_ticks + 1.0);
    if (period > 60) continue;
    ++checked;
    EXPECT_LE(Played(loop, {most, damping}).growth() * period,
              std::log(1 - kLossAPeriod) + std::log(period) * period / 3000)
        << i;
  }
  EXPECT_GT(checked, 20);
}

// The rule for long delays asks for no less than the one by modes.
TEST(SampledLoop, WithALongDelayTheRuleIsOnTheSafeSide) {
  Dice dice(9);
  for (int i = 0; i < 100; ++i) {
    SampledLoop loop = heldLoop(dice);
    loop.delay_ticks = kMostExactDelay + 1 + dice.upTo(30);
    const double most = settlingStiffness(loop, 0);
    ASSERT_GT(most, 0) << i;
    const std::complex<double> z = greatestEigenvalue(loop, {most, 0});
    const double turn = std::abs(std::arg(z));
    if (turn < 1e-6) continue;
    const double period = std::max(2 * M_PI / turn, loop.delay_ticks + 1.0);
    EXPECT_GE(1 - std::pow(std::abs(z), period), kLossAPeriod) << i << " d " << loop.delay_ticks;
  }
}

// Ten kilograms in a light hand ring whatever the wall is. No wall is asked to damp them more than half as much as they
// do by themselves.
TEST(SampledLoop, AToolThatRingsByItselfHasAWallToo) {
  SampledLoop loop;
  loop.hand = {0.05, 1, 100, 10, 0.05};
  const double most = settlingStiffness(loop, 0);
  EXPECT_GT(most, 10);
  EXPECT_LT(most, 0.9 * stiffnessBound(loop, 0));
}

TEST(SampledLoop, TheBoundsOfDampingDelayAndRateLieOnTheSameBorder) {
  Dice dice(4);
  int damped = 0, delayed = 0, rated = 0;
  for (int i = 0; i < 200; ++i) {
    const SampledLoop loop = anyLoop(dice);
    const Wall wall = {dice.decades(10, 1e4), dice.decades(0.01, 10)};
    const double most = dampingBound(loop, wall.stiffness_N_per_m);
    if (most > 0 && most < kMostDamping_Ns_per_m) {
      ++damped;
      EXPECT_TRUE(isStable(loop, {wall.stiffness_N_per_m, most}));
      EXPECT_FALSE(isStable(loop, {wall.stiffness_N_per_m, most * (1 + 1.01 * kBoundPrecision)}));
    }
    SampledLoop late = loop;
    late.delay_ticks = delayBound(loop, wall, 20);
    if (late.delay_ticks >= 0 && late.delay_ticks < 20) {
      ++delayed;
      EXPECT_TRUE(isStable(late, wall));
      ++late.delay_ticks;
      EXPECT_FALSE(isStable(late, wall));
    }
    SampledLoop fast = loop;
    fast.rate_hz = rateBound(loop, wall);
    if (fast.rate_hz < kHighestRate_hz && fast.rate_hz > 1.01) {
      ++rated;
      EXPECT_TRUE(isStable(fast, wall));
      fast.rate_hz /= 1 + 1.01 * kBoundPrecision;
      EXPECT_FALSE(isStable(fast, wall));
    }
  }
  EXPECT_GT(damped, 100);
  EXPECT_GT(delayed, 60);
  EXPECT_GT(rated, 60);
}

TEST(SampledLoop, NothingHoldsTheBoundsThatNothingCanHold) {
  SampledLoop loose;  // no damping anywhere: unstable at any stiffness
  loose.hand = {0, 0, 0, 0.1, 0};
  EXPECT_EQ(stiffnessBound(loose, 0), 0);
  EXPECT_EQ(delayBound(loose, {100, 0}), -1);
  EXPECT_EQ(rateBound(loose, {100, 0}), std::numeric_limits<double>::infinity());
  EXPECT_EQ(stiffnessBound(loose, 1e4), 0);  // far too much damping
  EXPECT_EQ(dampingBound(loose, 1e9), 0);    // far too stiff for any
  EXPECT_GT(dampingBound(loose, 100), 1);    // damping alone makes it stable
  SampledLoop heavy;                         // a tonne of damping: no bound within the grid
  heavy.hand.device_damping_Ns_per_m = 1e9;
  EXPECT_EQ(stiffnessBound(heavy, 0), kStiffest_N_per_m);
  EXPECT_EQ(delayBound(heavy, {1, 0}, 7), 7);
}

// Without a wall a hand comes to rest on its own, and a mass that nothing holds does not: it stays where it is. A wall
// that pulls outward is borne as long as the hand is the stiffer one.
TEST(SampledLoop, WithoutAWallOnlyTheHandsSpringSettles) {
  for (const int delay_ticks : {0, 1, 10000}) {
    for (const double rate_hz : {50.0, 1000.0, 20000.0}) {
      SampledLoop held;
      held.delay_ticks = delay_ticks;
      held.rate_hz = rate_hz;
      EXPECT_TRUE(isStable(held, {0, 0})) << delay_ticks;
      EXPECT_TRUE(isStable(held, {-1e-3 * held.hand.hand_stiffness_N_per_m, 0})) << delay_ticks;
      EXPECT_FALSE(isStable(held, {-1.001 * held.hand.hand_stiffness_N_per_m, 0})) << delay_ticks;
      for (const double damping : {0.1, 1e3}) {  // of the device
        SampledLoop free = held;
        free.hand = {0, 0, 0, 0.01, damping};
        EXPECT_FALSE(isStable(free, {0, 0})) << delay_ticks << ' ' << rate_hz;
        EXPECT_FALSE(isStable(free, {0, 1e-3})) << delay_ticks << ' ' << rate_hz;
        EXPECT_TRUE(isStable(free, {1e-5, 0})) << delay_ticks << ' ' << rate_hz;  // K L / b is 0.02 at the most
      }
    }
  }
}

TEST(SampledLoop, RefusesWhatIsNoLoop) {
  SampledLoop loop;
  loop.delay_ticks = -1;
  EXPECT_THROW(static_cast<void>(isStable(loop, {})), Error);
  EXPECT_THROW(static_cast<void>(transitionMatrix(loop, {})), Error);
  loop.delay_ticks = 0;
  for (const double none : {std::numeric_limits<double>::quiet_NaN(), std::numeric_limits<double>::infinity()}) {
    EXPECT_THROW(static_cast<void>(isStable(loop, {none, 0})), Error);
    EXPECT_THROW(static_cast<void>(isStable(loop, {0, none})), Error);
  }
  loop.hand.hand_mass_kg = loop.hand.device_mass_kg = 0;
  EXPECT_THROW(static_cast<void>(transitionMatrix(loop, {})), Error);
}

}  // namespace sampled_loop_test
}  // namespace palpate
