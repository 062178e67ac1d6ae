// SPDX-License-Identifier: Apache-2.0
// hri's planes keep up with the tool: by age, which a user sets (n), and by way, at every speed, depth and curvature.
//
// Every slide is at depth D below a surface whose distance is a formula, without damping, so that the force ought to be
// K D along the exact normal.
#include <gtest/gtest.h>

#include "base/units.hpp"
#include "servo/algorithms/hri.hpp"
#include "servo/safety/faults.hpp"
#include "support/algorithm_driver.hpp"
#include "support/sampled_volume.hpp"
#include "tests/support/long_run.hpp"

namespace palpate {
namespace way_and_age_test {

constexpr double kStiffness = 500;  // [N/m]
constexpr double kTick_s = 1e-3;

AlgorithmParameters withAge(int n) {
  return {.isovalue = 0, .stiffness_N_per_m = kStiffness, .damping_Ns_per_m = 0, .plane_renewal_ticks = n};
}
int randomAge(Seeded& random) {
  return static_cast<int>(std::lround(random.logBetween(1, 1000)));
}
double angleBetween(const Vec3& a, const Vec3& b) {
  return std::atan2(a.cross(b).norm(), a.dot(b));
}

// The force of a slide against K times the depth along the normal.
struct Worst {
  double most = 1, least = 1;  // share of K D
  double radians = 0;
  int ticks = 0, lost = 0;
  std::uint32_t faults = 0;

  void see(const TickOutput& out, double depth_m, const Vec3& normal_W) {
    ++ticks;
    faults |= out.faults;
    if (!out.in_contact) {
      ++lost;
      return;
    }
    const double share = out.force_W.norm() / (kStiffness * depth_m);
    most = std::max(most, share);
    least = std::min(least, share);
    radians = std::max(radians, angleBetween(out.force_W, normal_W));
  }
};

// Along a great circle of a ball, inside it or, in a hollow, outside.
struct Circle {
  Vec3 centre_W, u, v;
  [[nodiscard]] Vec3 at(double angle, double radius_m) const {
    return centre_W + (u * std::cos(angle) + v * std::sin(angle)) * radius_m;
  }
};
Circle randomCircle(Seeded& random, const Vec3& centre_W) {
  const Vec3 u = random.direction();
  return {centre_W, u, random.across(u)};
}

// The whole range of n and speed on a ball of 40 voxels, 4 voxels deep.
TEST(WayAndAge, OnABallTheForceIsRightAtEverySpeedAndAge) {
  constexpr double kRadius = 20e-3;
  constexpr double kDepth = 2e-3;
  const Vec3 centre_W = Vec3::Constant(24.13e-3);
  Sampling sampling{.size = Vec3i::Constant(97), .flat_m = 2e-3};
  sampling.lattice.spacing_m = Vec3::Constant(0.5e-3);
  const AnalyticVolume volume = stored(sampledOn(sampling, ballSurface(centre_W, kRadius)));
  Seeded random(1);
  Worst all;
  for (int trial = 0; trial < 150; ++trial) {
    const int n = randomAge(random);
    const double speed = random.logBetween(0.01, 2);  // [m/s]
    const Circle circle = randomCircle(random, centre_W);
    Hri hri(withAge(n));
    AlgorithmDriver driver(hri, volume, circle.at(0, kRadius + 1e-3));
    driver.around_vhip = true;
    driver.at(circle.at(0, kRadius + 1e-3));
    driver.stroke(circle.at(0, kRadius - kDepth), 1 + random.pick(100));
    Worst worst;
    const double step = speed * kTick_s / (kRadius - kDepth);  // [rad]
    for (double angle = step; angle < std::min(3.0, 2000 * step); angle += step) {
      const Vec3 hip_W = circle.at(angle, kRadius - kDepth);
      worst.see(driver.at(hip_W), kDepth, hip_W - centre_W);
    }
    SCOPED_TRACE(testing::Message() << "trial " << trial << ", n " << n << ", " << speed << " m/s");
    EXPECT_LE(worst.most, 1.1);
    EXPECT_GE(worst.least, 1 / 1.1);
    EXPECT_LE(worst.radians * kDegreesPerRadian, 8);
    EXPECT_EQ(worst.lost, 0);
    EXPECT_EQ(worst.faults, 0U) << faultNames(worst.faults);
    all.most = std::max(all.most, worst.most);
    all.radians = std::max(all.radians, worst.radians);
    all.ticks += worst.ticks;
  }
  EXPECT_GT(all.ticks, 30000);
  RecordProperty("most", std::to_string(all.most));
  RecordProperty("degrees", std::to_string(all.radians * kDegreesPerRadian));
}

// Along and around a knot's tube of 8 voxels, up to half of its radius deep.
TEST(WayAndAge, OnAKnotTheForceIsRightUpToHalfAMetreASecond) {
  const Vec3 centre_W = Vec3::Constant(47.7e-3);
  const TorusKnot knot(centre_W, 60e-3, 8e-3);
  const AnalyticSurface surface = knot.surface();
  // Only what the way needs: t from 0 to 1.3 of the curve, 12 mm around.
  Vec3 low_W = centre_W, high_W = centre_W;
  for (double t = 0; t < 1.3; t += 0.01) {
    low_W = low_W.cwiseMin(knot.below(t, 0, 8e-3) - Vec3::Constant(13e-3));
    high_W = high_W.cwiseMax(knot.below(t, 0, 8e-3) + Vec3::Constant(13e-3));
  }
  Sampling sampling;
  sampling.lattice.origin_W = low_W;
  sampling.size = ((high_W - low_W) / 1e-3).array().ceil().cast<int>();
  const AnalyticVolume volume = stored(sampledOn(sampling, surface));
  Seeded random(2);
  Worst all;
  for (int trial = 0; trial < 120; ++trial) {
    const int n = randomAge(random);
    const double speed = random.logBetween(0.01, 0.5);  // [m/s]
    const double depth_m = random.between(0.5e-3, 4e-3);
    const double along = random.between(0.2, 1);  // in t
    const double around = random.between(-6, 6);  // in the angle around the tube, for the same way
    double t = random.between(0.05, 0.2);
    double turn = random.between(0, 6);
    Hri hri(withAge(n));
    AlgorithmDriver driver(hri, volume, knot.below(t, turn, -1e-3));
    driver.around_vhip = true;
    driver.at(knot.below(t, turn, -1e-3));
    driver.stroke(knot.below(t, turn, depth_m), 1 + random.pick(60));
    Worst worst;
    for (int tick = 0; tick < 500 && t < 1.2; ++tick) {
      constexpr double kLittle = 1e-4;
      const double unit_m =
          (knot.below(t + kLittle * along, turn + kLittle * around, depth_m) - knot.below(t, turn, depth_m)).norm();
      const double step = speed * kTick_s / unit_m * kLittle;
      t += step * along;
      turn += step * around;
      const Vec3 hip_W = knot.below(t, turn, depth_m);
      worst.see(driver.at(hip_W), -surface.distance_m(hip_W), surface.normal(hip_W));
    }
    SCOPED_TRACE(testing::Message() << "trial " << trial << ", n " << n << ", " << speed << " m/s, " << depth_m / 1e-3
                                    << " voxels deep");
    EXPECT_LE(worst.most, 1.2);
    EXPECT_GE(worst.least, 1 / 1.2);
    EXPECT_LE(worst.radians * kDegreesPerRadian, 15);
    EXPECT_EQ(worst.lost, 0);
    EXPECT_EQ(worst.faults, 0U) << faultNames(worst.faults);
    all.most = std::max(all.most, worst.most);
    all.least = std::min(all.least, worst.least);
    all.radians = std::max(all.radians, worst.radians);
    all.ticks += worst.ticks;
  }
  EXPECT_GT(all.ticks, 20000);
  RecordProperty("most", std::to_string(all.most));
  RecordProperty("least", std::to_string(all.least));
  RecordProperty("degrees", std::to_string(all.radians * kDegreesPerRadian));
}

// Balls and hollows of 8 to 60 voxels, 0.3 voxel to 0.6 R deep, every n, every speed, in cubes and in voxels up to six
// times as long as wide, on lattices of any turn and hand; voxels are counted by their smallest side. What hri.hpp
// promises of a plane: its normal is turned by at most kMostTurned, and it is off by at most kMostOff of the depth or
// kLeastOff, once the rate of turning is known. Besides:
// - Before it is known it is taken for kFirstTurn. Where normals turn faster, by 1 / (R - D) a voxel, the first plane
//   may turn by that much more.
// - The way of one tick is made before the plane can be renewed, but a renewal is in the same tick, so adds nothing.
// - Sampling: a normal that is off by e moves the point whose normal line meets the HIP, by e D R / (R -+ D) along the
//   surface; line and normal are then both off by e R / (R -+ D) (- where it is convex). The curvature is taken at the
//   innermost sample that a gradient reads: a voxel's diagonal and its longest side below the surface.
// - The rate is measured between two planes that are each off by that much, s: it may come out too low by 2 s of what
//   the normal turned, but never as less than half of the rate before. The first two planes are the nearest to each
//   other: touched where the depth is nothing, the first one holds as far as kLeastOff and kFirstTurn let it.
// - The search ends kAimTolerance beside the normal line, which is over R -+ D an angle.
// - Depth along a normal that is off by t differs by the cosine of t, and by the sag over t at the surface, t^2 R / 2.
TEST(WayAndAge, OnBallsAndHollowsOfEveryRadiusTheErrorIsWhatTheHeaderSays) {
  constexpr double kVoxel = 1e-3;
  Seeded random(3);
  int ticks = 0;
  double largest_share = 0;
  for (int trial = 0; trial < 240; ++trial) {
    const bool is_hollow = trial % 2 == 1;
    const double longest = trial % 4 < 2 ? 1 : random.between(1, 6);     // side of the voxel [voxel]
    const double R = random.logBetween(std::max(8.0, 6 * longest), 60);  // [voxel]
    const double D = random.logBetween(0.3, 0.6 * R);                    // [voxel]
    const double along = is_hollow ? R + D : R - D;                      // radius of the HIP's circle [voxel]
    const int n = randomAge(random);
    const double speed = random.logBetween(0.01, 1);  // [m/s]
    const Vec3 centre_W = random.inCube(5e-3);
    const AnalyticSurface solid = ballSurface(centre_W, R * kVoxel);
    Vec3 spacing_m = Vec3::Constant(kVoxel);
    spacing_m[random.pick(3)] *= longest;
    Sampling sampling{.size = Vec3i::Constant(220), .flat_m = 4 * longest * kVoxel};
    sampling.lattice =
        latticeAround(centre_W, sampling.size, spacing_m, random.axes(trial % 8 < 4), random.inCube(0.5));
    const AnalyticVolume volume = sampledOn(sampling, is_hollow ? hollow(solid) : solid);
    const Circle circle = randomCircle(random, centre_W);
    Hri hri(withAge(n));
    const double out = is_hollow ? -1 : 1;
    AlgorithmDriver driver(hri, volume, circle.at(0, (R + out) * kVoxel));
    driver.around_vhip = true;
    driver.at(circle.at(0, (R + out) * kVoxel));
    driver.stroke(circle.at(0, along * kVoxel), 5 + random.pick(200));

    const SampledBound field = sampledBound(R * kVoxel - spacing_m.norm() - spacing_m.maxCoeff(), spacing_m);
    const double sampled = field.radians * R / along;
    const double first = std::max(1.0, 1 / (along * HriSurface::kFirstTurn));
    const double first_turn = std::sqrt(2 * HriSurface::kLeastOff / HriSurface::kFirstTurn) / along;
    const double measured = 1 / (1 - std::min(0.5, 2 * sampled / std::min(first_turn, HriSurface::kMostTurned)));
    const double longer = std::max(first, measured);  // than the reach ought to be
    const double turned = HriSurface::kMostTurned * longer + sampled + HriSurface::kAimTolerance / along;
    const double off_voxel = std::max(HriSurface::kMostOff * D, HriSurface::kLeastOff) * longer +
                             field.metres / kVoxel + 0.5 * turned * turned * D + HriSurface::kAimTolerance * turned;
    double worst_turned = 0, worst_new = 0, worst_off = 0;
    const double step = speed * kTick_s / (along * kVoxel);
    for (double angle = step; angle < std::min({2.5, 1500 * step, 80 / R}); angle += step, ++ticks) {
      const Vec3 hip_W = circle.at(angle, along * kVoxel);
      const TickOutput tick = driver.at(hip_W);
      ASSERT_TRUE(tick.in_contact) << "trial " << trial;
      ASSERT_EQ(tick.faults, 0U) << "trial " << trial << " " << faultNames(tick.faults);
      worst_turned = std::max(worst_turned, angleBetween(tick.force_W, out * (hip_W - centre_W)));
      if (tick.plane_age_ticks == 0) {
        worst_new = std::max(worst_new, angleBetween(tick.force_W, out * (hip_W - centre_W)));
      }
      worst_off = std::max(worst_off, std::abs(tick.force_W.norm() / kStiffness / kVoxel - D));
    }
    SCOPED_TRACE(testing::Message() << "trial " << trial << (is_hollow ? " hollow" : " ball") << " of " << R
                                    << " voxels, " << D << " deep, n " << n << ", " << speed << " m/s");
    EXPECT_LE(worst_turned, turned);
    // A new plane is ahead of the HIP by no more than kAimInReach of that.
    EXPECT_LE(worst_new,
              HriSurface::kAimInReach * HriSurface::kMostTurned * longer + sampled + HriSurface::kAimTolerance / along);
    EXPECT_LE(worst_off, off_voxel);
    largest_share = std::max({largest_share, worst_turned / turned, worst_off / off_voxel});
  }
  EXPECT_GT(ticks, 30000);
  EXPECT_GT(largest_share, 0.5);  // the bound says something
  RecordProperty("largest_share", std::to_string(largest_share));
}

// A tool that goes far in one tick, farther than windows of the program are wide. What the search reaches is right;
// what it does not reach is told, and right again when the tool stays.
TEST(WayAndAge, OnAPlaneAWayOfSixtyVoxelsIsFollowedAndMoreIsTold) {
  constexpr double kVoxel = 1e-3;
  Seeded random(4);
  const int trials = isLongRun() ? 40 : 16;
  int told = 0;
  for (int trial = 0; trial < trials; ++trial) {
    const Vec3 normal_W = random.direction();
    const Vec3 aside_W = random.across(normal_W);
    Sampling sampling{.size = Vec3i::Constant(400)};
    sampling.lattice = latticeAround(Vec3::Zero(), sampling.size, Vec3::Constant(kVoxel));
    const AnalyticVolume volume = sampledOn(sampling, planeSurface(Vec3::Zero(), normal_W));
    const double depth_m = random.logBetween(0.1, 10) * kVoxel;
    const double way_voxel = trial % 2 == 0 ? random.between(1, 60) : random.between(66.1, 100);
    const auto at = [&](double voxels, double d_m) {
      return Vec3(aside_W * ((voxels - way_voxel / 2) * kVoxel) - normal_W * d_m);
    };
    const int n = randomAge(random);
    Hri hri(withAge(n));
    AlgorithmDriver driver(hri, volume, at(0, -kVoxel), static_cast<int>(way_voxel) + 40);
    driver.follow = false;
    driver.publish(at(way_voxel / 2, 0));
    driver.at(at(0, -kVoxel));
    ASSERT_TRUE(driver.at(at(0, depth_m)).in_contact);
    SCOPED_TRACE(testing::Message() << "trial " << trial << ", " << way_voxel << " voxels aside, " << depth_m / kVoxel
                                    << " deep, n " << n);
    TickOutput out = driver.at(at(way_voxel, depth_m));
    if (way_voxel > 66) {
      EXPECT_EQ(out.faults, bit(ServoFault::kPlaneBehind)) << faultNames(out.faults);
      ++told;
      for (int tick = 0; tick < 3; ++tick) out = driver.at(at(way_voxel, depth_m));
    }
    EXPECT_EQ(out.faults, 0U) << faultNames(out.faults);
    ASSERT_TRUE(out.in_contact);
    // Floats: some 1e-5 voxel and radians (accuracy_test.cpp).
    EXPECT_LT((out.force_W - kStiffness * depth_m * normal_W).norm(), 1e-4 * kStiffness * kVoxel);
  }
  EXPECT_EQ(told, trials / 2);
  EXPECT_TRUE((kFadingFaults & bit(ServoFault::kPlaneBehind)) != 0);
}

// Where the surface is curved a plane that stayed behind is wrong, however long it may live by its age: it is followed
// on. Of every three contacts one begins with that way.
TEST(WayAndAge, APlaneThatIsBehindIsFollowedOnWithTheToolAtRest) {
  constexpr double kVoxel = 1e-3;
  constexpr double R = 100;  // [voxel]
  Seeded random(6);
  const int trials = isLongRun() ? 12 : 6;  // six: each kind of contact with each age
  for (int trial = 0; trial < trials; ++trial) {
    const double D = random.between(1, 20);  // [voxel]
    const double angle = random.between(1.15, 1.4);
    ASSERT_GT((R - D) * std::sin(angle), SurfaceTracker::kMaxWay + 1);
    Sampling sampling{.size = Vec3i::Constant(260)};
    sampling.lattice = latticeAround(Vec3::Zero(), sampling.size, Vec3::Constant(kVoxel));
    const AnalyticVolume volume = sampledOn(sampling, ballSurface(Vec3::Zero(), R * kVoxel));
    const Circle circle = randomCircle(random, Vec3::Zero());
    Hri hri(withAge(trial % 2 == 0 ? 1000 : 5));
    AlgorithmDriver driver(hri, volume, circle.at(0, (R + 1) * kVoxel), 160);
    driver.follow = false;
    driver.publish(circle.at(0.5 * angle, R * kVoxel));
    const bool begins = trial % 3 == 0;
    driver.at(circle.at(0, (R + (begins ? 0.01 : 1)) * kVoxel));
    for (int i = 1; i <= 20 && !begins; ++i) driver.at(circle.at(0, (R - D * i / 20) * kVoxel));
    const Vec3 hip_W = circle.at(angle, (R - D) * kVoxel);
    SCOPED_TRACE(testing::Message() << "trial " << trial << ", " << D << " deep, " << angle << " rad");
    EXPECT_EQ(driver.at(hip_W).faults, bit(ServoFault::kPlaneBehind));
    TickOutput out;
    for (int tick = 0; tick < 3; ++tick) out = driver.at(hip_W);
    EXPECT_EQ(out.faults, 0U) << faultNames(out.faults);
    ASSERT_TRUE(out.in_contact);
    EXPECT_LE(angleBetween(out.force_W, hip_W) * kDegreesPerRadian, 1);
  }
}

// Over balls and hollows, up to a quarter of a turn in one tick. The old plane is tangential where the tool was, so the
// search sees a shorter way than it is; where its steps do not reach, it must say so.
TEST(WayAndAge, AForceAfterALongWayIsRightOrAFaultSaysThatItIsNot) {
  constexpr double kVoxel = 1e-3;
  Seeded random(5);
  const int trials = isLongRun() ? 80 : 32;
  int right = 0, told = 0;
  for (int trial = 0; trial < trials; ++trial) {
    const bool is_hollow = trial % 2 == 1;
    const double R = random.logBetween(10, 60);                            // [voxel]
    const double D = random.logBetween(0.3, 0.5 * R);                      // [voxel]
    const double along = is_hollow ? R + D : R - D;                        // [voxel]
    const double way = std::min(60.0, random.between(0.05, 1.5) * along);  // [voxel]
    const Vec3 centre_W = random.inCube(5e-3);
    const AnalyticSurface solid = ballSurface(centre_W, R * kVoxel);
    Sampling sampling{.size = Vec3i::Constant(260)};
    sampling.lattice = latticeAround(centre_W, sampling.size, Vec3::Constant(kVoxel));
    const AnalyticVolume volume = sampledOn(sampling, is_hollow ? hollow(solid) : solid);
    const Circle circle = randomCircle(random, centre_W);
    const int n = randomAge(random);
    Hri hri(withAge(n));
    const double out = is_hollow ? -1 : 1;
    AlgorithmDriver driver(hri, volume, circle.at(0, (R + out) * kVoxel),
                           static_cast<int>(std::min(60.0, way) * R / along) + 48);
    driver.follow = false;
    driver.publish(circle.at(0.5 * way / along, R * kVoxel));
    driver.at(circle.at(0, (R + out) * kVoxel));
    for (int tick = 0; tick < 5; ++tick) driver.at(circle.at(0, (R - out * 0.2 * (tick + 1) * D) * kVoxel));
    const Vec3 hip_W = circle.at(way / along, along * kVoxel);
    SCOPED_TRACE(testing::Message() << "trial " << trial << (is_hollow ? " hollow" : " ball") << " of " << R
                                    << " voxels, " << D << " deep, n " << n << ", " << way << " voxels aside");
    const auto off = [&](const TickOutput& tick) {
      return tick.in_contact ? angleBetween(tick.force_W, out * (hip_W - centre_W)) * kDegreesPerRadian : 180;
    };
    TickOutput tick = driver.at(hip_W);
    if ((tick.faults & kFadingFaults) == 0) {
      EXPECT_LE(off(tick), 8);
      ++right;
    } else {
      ++told;
    }
    for (int again = 0; again < 10; ++again) tick = driver.at(hip_W);
    EXPECT_EQ(tick.faults, 0U) << faultNames(tick.faults);
    EXPECT_LE(off(tick), 8);
  }
  EXPECT_GT(right, trials * 3 / 4);
  RecordProperty("told", told);
}

// From a round edge of 8 voxels onto a flat face: the rate of turning may fall by half from one plane to the next, so a
// plane holds for at most twice the way of the one before, and a tick's way more; until kLeastTurn, or the depth's
// share of it, says how long. And it does grow.
TEST(WayAndAge, BehindACurvePlanesHoldForLongerStepByStep) {
  constexpr double kVoxel = 1e-3, R = 8 * kVoxel, D = 2 * kVoxel, kStep = 0.1 * kVoxel;
  const AnalyticSurface edge = {
      [=](const Vec3& p_W) { return p_W.x() < 0 ? std::hypot(p_W.x(), p_W.z() + R) - R : p_W.z(); },
      [=](const Vec3& p_W) { return p_W.x() < 0 ? Vec3(Vec3(p_W.x(), 0, p_W.z() + R).normalized()) : Vec3(0, 0, 1); }};
  Sampling sampling{.size = Vec3i::Constant(120)};
  sampling.lattice = latticeAround(Vec3(20e-3, 0, 0), sampling.size, Vec3::Constant(kVoxel));
  const AnalyticVolume volume = sampledOn(sampling, edge);
  const auto hip = [&](double way_m) {  // 0 where the edge ends
    const double angle = way_m / (R - D);
    return way_m < 0 ? Vec3(std::sin(angle) * (R - D), 0, std::cos(angle) * (R - D) - R) : Vec3(way_m, 0, -D);
  };
  Hri hri(withAge(1000));
  constexpr double kBegin = -6 * kVoxel;
  AlgorithmDriver driver(hri, volume, hip(kBegin) + (R - 4 * kVoxel) * edge.normal(hip(kBegin)));
  driver.around_vhip = true;
  driver.stroke(hip(kBegin), 40);
  std::vector<double> ways;  // that planes held for, of those found on the face or just before it
  double since_m = 0;
  for (double way_m = kBegin; way_m < 50 * kVoxel; way_m += kStep) {
    const TickOutput out = driver.at(hip(way_m));
    ASSERT_TRUE(out.in_contact);
    since_m += kStep;
    if (out.plane_age_ticks != 0) continue;
    if (way_m > -kVoxel) ways.push_back(since_m);
    since_m = 0;
  }
  ASSERT_GT(ways.size(), 5U);
  for (std::size_t i = 1; i < ways.size(); ++i) EXPECT_LE(ways[i], 2 * ways[i - 1] + kStep) << i;
  EXPECT_GT(ways.back(), 2.5 * ways.front());
}

}  // namespace way_and_age_test
}  // namespace palpate
