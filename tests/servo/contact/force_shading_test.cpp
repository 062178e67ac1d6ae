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

constexpr double kVoxel = 1e-3;
constexpr double kDepth = 1e-3;
const Vec3 kSurface(16e-3, 16e-3, 16e-3);

double degreesBetween(const Vec3& a, const Vec3& b) {
  return std::atan2(a.cross(b).norm(), a.dot(b)) * kDegreesPerRadian;
}

// Density falls along `normal_W`: every gradient is -normal_W, every shading plane has that normal.
class ShadingTest : public testing::Test {
 protected:
  void level(const Vec3& normal_W) {
    volume_ = millimetreVolume([=](const Vec3& p) { return normal_W.dot(kSurface - p); }, 32);
    volume_.hold(held_, Vec3i::Zero(), volume_.size, held_.window.version + 1);
    contact_.window = &held_.window;
    contact_.plane_T.p_W = kSurface;
  }
  Vec3 at(const Vec3& from_surface_W) { return contact_.at(kSurface + from_surface_W) - kSurface; }

  AnalyticVolume volume_;
  HeldWindow held_;
  ForceShading shading_;
  PlaneContact contact_{shading_};
};

Vec3 normalAt(double degrees) {
  const double angle = degrees / kDegreesPerRadian;
  return {std::sin(angle), 0, std::cos(angle)};
}

// Gradients are floats: 1e-7 of a direction.
constexpr double kFloat = 1e-6;

// At rest the VHIP goes to where d lies along the shading normal, by sin^2 of the angle each tick; the depth is kept.
TEST_F(ShadingTest, AtRestTheForceTurnsToTheShadingNormal) {
  for (const double degrees : {1.0, 10.0, 30.0, 44.0}) {
    contact_.leave();
    level(normalAt(degrees));
    const Vec3 hip(0, 0, -kDepth);
    EXPECT_EQ(at(hip), Vec3::Zero());  // first contact: as it came
    const double shift_m = kDepth * std::tan(degrees / kDegreesPerRadian);
    const double ratio = std::pow(std::sin(degrees / kDegreesPerRadian), 2);
    double missing = 1;
    for (int k = 0; k < 60; ++k) {
      missing *= ratio;
      const Vec3 vhip = at(hip);
      EXPECT_NEAR(vhip.x(), shift_m * (1 - missing), kFloat * shift_m) << degrees << " " << k;
      EXPECT_NEAR(vhip.y(), 0, kFloat * shift_m);
      EXPECT_NEAR(vhip.z(), 0, 1e-17);
    }
  }
}

// Beyond 45 degrees it stays at 45; more than a right angle is another sheet.
TEST_F(ShadingTest, TurnsByHalfARightAngleAtMost) {
  for (const double degrees : {46.0, 60.0, 80.0, 89.0}) {
    contact_.leave();
    level(normalAt(degrees));
    Vec3 vhip;
    for (int k = 0; k < 200; ++k) {
      vhip = at({0, 0, -kDepth});
      ASSERT_LE(vhip.norm(), ForceShading::kSteepest * kDepth * (1 + 1e-12));
    }
    EXPECT_NEAR(vhip.x(), kDepth, kFloat * kDepth) << degrees;
  }
  for (const double degrees : {91.0, 135.0, 180.0}) {
    contact_.leave();
    level(normalAt(degrees));
    for (int k = 0; k < 10; ++k) EXPECT_EQ(at({0, 0, -kDepth}), Vec3::Zero());
  }
}

TEST_F(ShadingTest, LeavesTheVhipWhereNothingIsKnown) {
  level(normalAt(20));
  const Vec3 hip(0, 0, -kDepth);
  at(hip);
  ASSERT_GT(at(hip).x(), 0);
  const std::uint64_t version = std::exchange(held_.window.version, 0);  // not usable
  EXPECT_EQ(at(hip), Vec3::Zero());
  held_.window.version = version + 1;
  EXPECT_GT(at(hip).x(), 0);
  at({-30e-3, 0, -kDepth});  // the VHIP is beyond the volume from now on
  EXPECT_EQ(at({-30e-3, 0, -kDepth}), Vec3(-30e-3, 0, 0));
  level(Vec3::Zero());  // flat
  at(hip);
  EXPECT_EQ(at(hip), Vec3::Zero());
}

TEST_F(ShadingTest, AToolInFrontOfTheShadingPlaneIsNotDrawnBack) {
  level(normalAt(45));
  at({0, 0, -kDepth});
  // Drawn out at once, in front of the shading plane through where the VHIP goes with it, but not of the true plane.
  at({0, 0, -kDepth});
  at({0, 0, -kDepth});
  ASSERT_GT(at({0, 0, -kDepth}).x(), 0.5 * kDepth);
  const Vec3 hip(0, 0, 3 * kDepth);
  EXPECT_NEAR((at(hip) - Vec3(0, 0, 0)).norm(), 0, 1e-17);
}

TEST_F(ShadingTest, ANewContactBeginsUnshaded) {
  level(normalAt(20));
  const Vec3 hip(0, 0, -kDepth);
  at(hip);
  ASSERT_GT(at(hip).x(), 0);
  contact_.leave();
  EXPECT_EQ(at(hip), Vec3::Zero());
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
// surface point gains on the tool in a tick, D / (R - D) of v T / R, and by its convergence, as much again at most; the
// interpolated gradient adds up to 0.5 degrees (hri_test.cpp, which finds that on the same ball at n = 1).
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
    ASSERT_LE((d - depth_m * out.normal_W).norm(), ForceShading::kSteepest * depth_m * (1 + 1e-9)) << i;
  }
  EXPECT_GT(in_contact, 300);
}

}  // namespace force_shading_test
}  // namespace palpate
