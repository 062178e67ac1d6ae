// SPDX-License-Identifier: Apache-2.0
// A joint of the emulated arm slips, or its hand strokes and taps: which of the two a Polhem takes for which.
#include <cstdlib>
#include <vector>

#include <gtest/gtest.h>

#include "servo/devices/polhem_device.hpp"
#include "servo/devices/typical_hands.hpp"
#include "support/polhem_bench.hpp"
#include "support/seeded.hpp"

namespace palpate {
namespace polhem_slips_test {

// A way through the workspace by strokes, each of some time and a tenth of a second of rest.
SampledPath strokes(Seeded& random, int count) {
  std::vector<double> times_s = {0, 0.05};
  std::vector<Vec3> points = {Vec3::Zero(), Vec3::Zero()};
  for (int i = 0; i < count; ++i) {
    const Vec3 to = 0.05 * random.direction();
    for (const double after_s : {random.between(0.06, 0.4), 0.1}) {
      times_s.push_back(times_s.back() + after_s);
      points.push_back(to);
    }
  }
  return {std::move(times_s), std::move(points), SampledPath::Interpolation::kCubic};
}

double wayOf(const PolhemBench& bench, std::size_t joint, std::int64_t counts) {
  const PolhemParameters p = knownPolhem();
  const ArmKinematics arm(p.joints, p.origin_m);
  ArmCounts now = bench.device.counts();
  const Vec3 before = arm.position(arm.angles(now));
  now[joint] += counts;
  return (arm.position(arm.angles(now)) - before).norm();
}

// From rest by 2 to 20 mm at the handle, at any joint. The first report changes nothing; with the third one the arm is
// not calibrated any more, and no force acts from then on, whatever is wanted.
TEST(PolhemSlips, ASlipIsNoMotion) {
  Seeded random(3);
  int cases = 0;
  while (cases < 120) {
    const SampledPath path({0}, {0.07 * random.direction()}, SampledPath::Interpolation::kLinear);
    PolhemBench bench(path);
    bench.pass(40);
    const auto joint = static_cast<std::size_t>(random.pick(3));
    const int counts = static_cast<int>(random.between(-2500, 2500));
    const double way_m = wayOf(bench, joint, counts);
    if (way_m < 2e-3 || way_m > 0.02) continue;
    SCOPED_TRACE(testing::Message() << "joint " << joint << ", " << counts << " counts, " << way_m << " m");
    ++cases;
    const Vec3 before = bench.position(), force(0, 0.5, 0);
    bench.pass(1);
    bench.emulated.slip(joint, counts);
    for (int report = 1; report <= 2; ++report) {
      bench.pass(1, force);
      ASSERT_EQ(bench.position(), before) << report;
      ASSERT_EQ(bench.figure("reports_implausible"), report);
      ASSERT_GT(bench.device.reportAge_ns(), 0);
    }
    bench.pass(1, force);
    ASSERT_EQ(bench.figure("reports_implausible"), 3);
    ASSERT_EQ(bench.device.forceOff(), ForceOff::kUncalibrated);
    bench.pass(5, force);
    ASSERT_EQ(bench.emulated.currents_A(), Vec3::Zero());
  }
}

// One report alone that is wrong by as much: it is counted, and all goes on.
TEST(PolhemSlips, OneWrongReportIsPassedOver) {
  PolhemBench bench(resting());
  bench.pass(40);
  const Vec3 before = bench.position();
  bench.emulated.slip(1, 800);
  bench.pass(1);
  bench.emulated.slip(1, -800);
  bench.pass(5);
  EXPECT_EQ(bench.position(), before);
  EXPECT_EQ(bench.device.forceOff(), ForceOff::kNone);
  EXPECT_EQ(bench.figure("reports_implausible"), 1);
}

// While the hand strokes: one slip of 12 to 18 mm in any report.
TEST(PolhemSlips, ASlipWithinAStrokeIsNoMotion) {
  for (unsigned seed = 0; seed < 40; ++seed) {
    Seeded random(seed);
    const SampledPath path = strokes(random, 4);
    PolhemBench bench(path, knownPolhem(), true, kTypicalHands[2].holding(HandParameters{}));
    bench.pass(60 + random.pick(500));
    const auto joint = static_cast<std::size_t>(random.pick(3));
    int counts = random.pick(2) == 0 ? 10 : -10;
    while (std::abs(counts) < 5000 && wayOf(bench, joint, counts) < 0.012) counts += counts > 0 ? 10 : -10;
    if (wayOf(bench, joint, counts) > 0.018) continue;
    SCOPED_TRACE(testing::Message() << seed << ", joint " << joint << ", " << counts << " counts");
    bench.emulated.slip(joint, counts);
    bench.pass(3);
    EXPECT_EQ(bench.device.forceOff(), ForceOff::kUncalibrated);
  }
}

// A stiff hand strokes fast through the workspace and taps on a wall as stiff as its maker states; nothing of it is
// taken for a slip. Nor of an arm that is hardly held, which the largest force throws to and fro.
TEST(PolhemSlips, StrokesAndTapsAreMotion) {
  double fastest_m_per_s = 0;
  for (unsigned seed = 0; seed < 20; ++seed) {
    SCOPED_TRACE(seed);
    Seeded random(seed);
    const bool is_free = seed % 4 == 0;
    const SampledPath path = is_free ? resting() : strokes(random, 10);
    // A light hand is left behind by such strokes, and then swings out of the emulated arm's reach.
    HandParameters hand = kTypicalHands[1 + seed % 2].holding(HandParameters{});
    if (is_free) hand.hand_stiffness_N_per_m = 200;  // as much as keeps the emulated arm within its reach
    PolhemBench bench(path, knownPolhem(), true, hand);
    Vec3 push = Vec3::Zero();
    for (int tick = 0; tick < 2500; ++tick) {
      if (is_free && tick % 40 == 0) push = 5 * random.direction();
      const double depth_m = -0.03 - bench.position().y();
      bench.pass(1, push + Vec3(0, depth_m > 0 ? 800 * depth_m : 0, 0));
      fastest_m_per_s = std::max(fastest_m_per_s, bench.emulated.hand().velocity_W.norm());
    }
    EXPECT_EQ(bench.figure("reports_implausible"), 0);
    EXPECT_EQ(bench.device.forceOff(), ForceOff::kNone);
  }
  EXPECT_GT(fastest_m_per_s, 1.5);
}

}  // namespace polhem_slips_test
}  // namespace palpate
