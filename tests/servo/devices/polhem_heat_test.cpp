// SPDX-License-Identifier: Apache-2.0
// A Polhem whose motors bear their largest current only for a while: what flows in the emulated arm, heated up by a sum
// of its own, never gets hotter than they bear.
#include <algorithm>
#include <cmath>
#include <utility>

#include <gtest/gtest.h>

#include "base/error.hpp"
#include "servo/devices/polhem_device.hpp"
#include "support/polhem_bench.hpp"
#include "support/seeded.hpp"

namespace palpate {
namespace polhem_heat_test {

PolhemParameters warming(double continuous_A, double heating_s) {
  PolhemParameters p = knownPolhem();
  p.force_limit_N = 100;
  p.continuous_current_A = continuous_A;
  p.heating_s = heating_s;
  return p;
}

// h += (i^2 - h) dt / tau by steps of a tick: off from the exponential by less than i^2 (dt / tau)^2 / 2 in each, which
// sums to i^2 dt / tau / 2 at most, as h leaks. Half a milliampere of rounding is 2 i 0.5e-3.
struct Heated {
  double heating_s;
  Vec3 heat_A2 = Vec3::Zero();
  double hottest_A2 = 0;
  void pass(const Vec3& currents_A) {
    heat_A2 += kPolhemTick_s / heating_s * (currents_A.cwiseAbs2() - heat_A2);
    hottest_A2 = std::max(hottest_A2, heat_A2.maxCoeff());
  }
  [[nodiscard]] double slack_A2() const { return 9 * kPolhemTick_s / heating_s / 2 + 2 * 3 * 0.5e-3; }
};

// Whatever is wanted, for however long, at any setting: forces that come and go, and one of all the device has.
TEST(PolhemHeat, NeverGetsHotterThanItBears) {
  for (unsigned seed = 0; seed < 24; ++seed) {
    SCOPED_TRACE(seed);
    Seeded random(seed);
    const double continuous_A = random.between(0.2, 1.5), heating_s = random.logBetween(0.1, 5);
    PolhemBench bench(resting(), warming(continuous_A, heating_s));
    Heated heated{heating_s};
    Vec3 force = Vec3::Zero();
    double hottest_A = 0;
    for (int tick = 0; tick < 6000; ++tick) {
      if (tick % 300 == 0) force = seed % 3 == 0 ? Vec3(0, 80, 0) : Vec3(random.between(0, 60) * random.direction());
      bench.pass(1, force);
      heated.pass(bench.emulated.currents_A());
      hottest_A = std::max(hottest_A, bench.emulated.currents_A().cwiseAbs().maxCoeff());
    }
    EXPECT_LE(heated.hottest_A2, continuous_A * continuous_A + heated.slack_A2());
    EXPECT_GT(hottest_A, 1.2 * continuous_A) << "a cold motor may have more";
    // One that always wants more ends at what is borne for ever.
    if (seed % 3 == 0) {
      EXPECT_NEAR(bench.emulated.currents_A().cwiseAbs().maxCoeff(), continuous_A, 0.02 * continuous_A + 1e-3);
    }
  }
}

// From what a cold motor has down to what is borne for ever: the force keeps its direction, and is told as it is. No
// tick takes more of i^2 than (i^2 - C^2) 1 ms / 0.5 s, a thousandth of i; the hand, which yields, makes it two.
TEST(PolhemHeat, ComesDownEvenlyAndKeepsTheDirection) {
  constexpr double kContinuous_A = 0.4, kHeating_s = 4;
  PolhemBench bench(resting(), warming(kContinuous_A, kHeating_s));
  const Vec3 force(1, 4.5, -1.5);
  double before_N = 0, first_N = 0;
  int full_ticks = 0;
  for (int tick = 0; tick < 10'000; ++tick) {
    ASSERT_TRUE(bench.device.write(force));
    const Vec3 held = bench.device.held(force);
    bench.device.elapse(1);
    static_cast<void>(bench.position());
    ASSERT_NEAR(held.normalized().dot(force.normalized()), 1, 1e-12);
    ASSERT_LE((bench.emulated.force_D() - held).norm(), 0.05) << tick;  // the arm's pose is a tick older
    if (tick == 0) first_N = before_N = held.norm();
    if (held.norm() > 0.999 * first_N) ++full_ticks;
    ASSERT_LE(before_N - held.norm(), 0.002 * first_N) << tick;
    before_N = held.norm();
  }
  EXPECT_GT(full_ticks, 100);
  EXPECT_LT(before_N, 0.75 * first_N);
}

TEST(PolhemHeat, CoolsDown) {
  PolhemBench bench(resting(), warming(0.4, 1));
  const Vec3 force(0, 20, 0);
  const double cold_N = bench.device.held(force).norm();
  bench.pass(4000, force);
  EXPECT_LT(bench.device.held(force).norm(), 0.8 * cold_N);
  bench.pass(8000);
  EXPECT_NEAR(bench.device.held(force).norm(), cold_N, 0.05 * cold_N);
}

TEST(PolhemHeat, IsNotThereUnlessItIsGiven) {
  PolhemBench bench(resting());
  const Vec3 force(0, 5, 0);
  bench.pass(4000, force);
  EXPECT_EQ(bench.device.held(force), force);
  for (const auto& [continuous_A, heating_s] : {std::pair(1.0, 0.0), std::pair(0.0, 1.0), std::pair(-1.0, 1.0)})
    EXPECT_THROW(checkPolhem(warming(continuous_A, heating_s)), Error);
}

}  // namespace polhem_heat_test
}  // namespace palpate
