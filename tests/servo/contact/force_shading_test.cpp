// SPDX-License-Identifier: Apache-2.0
#include "servo/contact/force_shading.hpp"

#include <algorithm>
#include <cmath>

#include <gtest/gtest.h>

#include "base/units.hpp"
#include "contact/plane_contact.hpp"
#include "servo/algorithms/hri.hpp"
#include "support/algorithm_driver.hpp"
#include "support/analytic_volume.hpp"

namespace palpate {
namespace force_shading_test {

constexpr double kDepth = 1e-3;

double degreesBetween(const Vec3& a, const Vec3& b) {
  return std::atan2(a.cross(b).norm(), a.dot(b)) * kDegreesPerRadian;
}

// Where the VHIP is put over the plane z = 0, with the HIP kDepth below the origin and a felt normal so far from z.
Vec3 vhipOf(double degrees, double depth_m = kDepth) {
  ContactState contact;
  contact.hip_W = Vec3(0, 0, -depth_m);
  contact.plane = {Vec3::Zero(), Vec3::UnitZ(), 0};
  const double angle = degrees / kDegreesPerRadian;
  contact.felt.normal_W = Vec3(std::sin(angle), 0, std::cos(angle));
  ContactPush push{.vhip_W = Vec3::Zero(), .energy_m2 = 0.5 * depth_m * depth_m};
  ForceShading shading;
  shading.move(contact, push);
  return push.vhip_W;
}

// d lies along the felt normal, and the depth is kept.
TEST(ForceShading, TheForceTurnsToTheFeltNormal) {
  for (const double degrees : {0.0, 1e-6, 1.0, 10.0, 29.9}) {
    const Vec3 vhip = vhipOf(degrees);
    EXPECT_NEAR(vhip.x(), kDepth * std::tan(degrees / kDegreesPerRadian), 1e-12 * kDepth) << degrees;
    EXPECT_EQ(vhip.y(), 0);
    EXPECT_EQ(vhip.z(), 0);
  }
}

// Beyond 30 degrees it stays at 30, from 73 on the move shrinks evenly with the cosine, and at a right angle there is
// none; nowhere is there a step: in a millidegree the tangent changes by 2 / 57300 at most.
TEST(ForceShading, TurnsByThirtyDegreesAtMostAndNotToAnotherSheet) {
  for (const double degrees : {31.0, 50.0, 73.0})
    EXPECT_NEAR(vhipOf(degrees).x(), ForceShading::kMostTurned * kDepth, 1e-12 * kDepth) << degrees;
  EXPECT_NEAR(vhipOf(80).x(), 2 * std::cos(80 / kDegreesPerRadian) * kDepth, 1e-12 * kDepth);
  for (const double degrees : {90.0 + 1e-9, 91.0, 135.0, 180.0}) EXPECT_EQ(vhipOf(degrees), Vec3::Zero());
  double last_m = 0;
  for (double degrees = 0; degrees < 100; degrees += 1e-3) {
    const double now_m = vhipOf(degrees).x();
    ASSERT_LE(std::abs(now_m - last_m), kDepth * 2.001 * 1e-3 / kDegreesPerRadian) << degrees;
    last_m = now_m;
  }
}

TEST(ForceShading, OnTheSurfaceThereIsNothingToTurn) {
  EXPECT_EQ(vhipOf(30, 0), Vec3::Zero());
}

// ---- with the algorithm, on a ball ----

constexpr double kRadius = 24e-3;
const Vec3 kCentre = Vec3::Constant(31.3e-3);

struct Errors {
  double largest_deg = 0;       // of the force's direction
  double largest_turn_deg = 0;  // from one tick to the next
};

// A slide 1 mm under a ball at `speed`, n ticks to a plane.
Errors slideOnBall(int n, double speed_m_per_s, bool shaded) {
  AlgorithmParameters p;
  p.plane_renewal_ticks = n;
  p.damping_Ns_per_m = 0;
  ContactEffects effects;
  if (shaded) effects.push_back(std::make_unique<ForceShading>());
  Hri hri(p, std::move(effects));
  const AnalyticVolume volume = millimetreVolume(ball(kCentre, kRadius));
  const Vec3 u = Vec3(1, 0.3, 0.2).normalized();
  const Vec3 v = u.cross(Vec3(0.1, -0.4, 1)).normalized();
  const auto at = [&](double angle, double radius_m) {
    return Vec3(kCentre + (u * std::cos(angle) + v * std::sin(angle)) * radius_m);
  };
  AlgorithmDriver driver(hri, volume, at(0, kRadius + kDepth));
  driver.stroke(at(0, kRadius - kDepth), 50);
  Errors errors;
  Vec3 last = Vec3::Zero();
  const double step = speed_m_per_s / 1000 / (kRadius - kDepth);
  for (int i = 0; i * step < 1.2; ++i) {
    const Vec3 hip = at(i * step, kRadius - kDepth);
    const TickOutput out = driver.at(hip);
    EXPECT_TRUE(out.in_contact);
    if (i < 3 * n) continue;
    errors.largest_deg = std::max(errors.largest_deg, degreesBetween(out.force_W, hip - kCentre));
    if (!last.isZero(0)) errors.largest_turn_deg = std::max(errors.largest_turn_deg, degreesBetween(out.force_W, last));
    last = out.force_W;
  }
  return errors;
}

// Unshaded, the force errs by up to 2 (n - 1) / 3 ticks of way: 0.6 mm on 23 mm, 1.49 degrees. Shaded, by what the
// surface point gains on the tool in a tick, D / (R - D) of v T / R, twice at most; the interpolated gradient adds up
// to 0.5 degrees (hri_test.cpp, which finds that on the same ball at n = 1).
TEST(ForceShadingOnABall, AtTenTicksTheForceIsCloseToTheSmoothNormal) {
  const Errors plain = slideOnBall(10, 0.1, false);
  const Errors shaded = slideOnBall(10, 0.1, true);
  EXPECT_GT(plain.largest_deg, 1.3);
  const double lag_deg = kDepth / (kRadius - kDepth) * 0.1e-3 / kRadius * kDegreesPerRadian;
  EXPECT_LT(shaded.largest_deg, 2 * lag_deg + 0.5);
  RecordProperty("plain_deg", std::to_string(plain.largest_deg));
  RecordProperty("shaded_deg", std::to_string(shaded.largest_deg));
  // The force turns with every tick, no longer by 2.5 degrees with every tenth.
  EXPECT_GT(plain.largest_turn_deg, 2.0);
  EXPECT_LT(shaded.largest_turn_deg, 0.25 * plain.largest_turn_deg);
  RecordProperty("plain_turn_deg", std::to_string(plain.largest_turn_deg));
  RecordProperty("shaded_turn_deg", std::to_string(shaded.largest_turn_deg));
}

// Where the tool is deeper than the groove is round (D > R), the projections would run away; the tilt stays bounded.
TEST(ForceShadingInAGroove, DoesNotRunAway) {
  const double R = 2.5e-3;
  const Vec3 axis(32e-3, 0, 40e-3);
  // Object around a pipe: concave, its normals point to the pipe's axis.
  const AnalyticVolume volume =
      millimetreVolume([=](const Vec3& p) { return std::hypot(p.x() - axis.x(), p.z() - axis.z()) - R; });
  AlgorithmParameters p;
  p.plane_renewal_ticks = 20;
  ContactEffects effects;
  effects.push_back(std::make_unique<ForceShading>());
  Hri hri(p, std::move(effects));
  const Vec3 start(32.2e-3, 32e-3, 40e-3);
  AlgorithmDriver driver(hri, volume, start);
  driver.at(start);
  int in_contact = 0;
  for (int i = 0; i < 400; ++i) {
    const double angle = 0.02 * i;
    const double radius_m = R + 0.02e-3 * std::min(i, 200);
    const Vec3 hip(axis.x() + radius_m * std::sin(angle), 32e-3, axis.z() - radius_m * std::cos(angle));
    const TickOutput out = driver.at(hip);
    if (!out.in_contact) continue;
    ++in_contact;
    const Vec3 d = out.vhip_W - hip;
    const double depth_m = out.normal_W.dot(d);
    ASSERT_TRUE(d.allFinite());
    ASSERT_LE((d - depth_m * out.normal_W).norm(), ForceShading::kMostTurned * depth_m * (1 + 1e-9)) << i;
  }
  EXPECT_GT(in_contact, 300);
}

}  // namespace force_shading_test
}  // namespace palpate
