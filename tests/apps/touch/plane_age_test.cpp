// SPDX-License-Identifier: Apache-2.0
// How far a plane ages: on balls, where the radius is known.
#include "apps/touch/plane_age.hpp"

#include <cmath>
#include <regex>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "servo/algorithms/registry.hpp"
#include "tests/apps/path/analytic_field.hpp"
#include "tests/servo/loop/wanted_path.hpp"
#include "tests/servo/support/seeded.hpp"

namespace palpate {
namespace plane_age_test {

using testing::HasSubstr;

AnalyticField ballField(double radius_m) {
  return {[radius_m](const Vec3& p_W) { return radius_m - p_W.norm(); }, 2 * radius_m, 0.2e-3};
}

// Ten seconds around a ball, `depth_m` deep, at `speed_m_per_s` at that depth.
WantedPath around(double radius_m, double depth_m, double speed_m_per_s) {
  const double r = radius_m - depth_m;
  return WantedPath([=](double t_s) {
    const double angle = speed_m_per_s / r * t_s;
    return Vec3(r * std::cos(angle), r * std::sin(angle), 0);
  });
}

// What the algorithm says of its planes' age where the tool is: at R - depth, where the level set has that radius.
// Normals a voxel h to each side are turned by 2 atan(h / r), so the curvature is that of the chord: short by at most
// (h / r)^2. The depth is that along the normal, exact in a field of distances.
TEST(PlaneAge, IsWhatTheAlgorithmSaysOfTheSurfaceUnderThePath) {
  Seeded random(41);
  for (int i = 0; i < 12; ++i) {
    const double radius_m = random.logBetween(5e-3, 50e-3), depth_m = 1e-3, speed_m_per_s = random.logBetween(0.01, 1);
    const int n = 1 + random.pick(50);
    const double rate_hz = random.logBetween(500, 5000);
    const AnalyticField ball = ballField(radius_m);
    const double h = ball.lattice().smallestSpacing(), r = radius_m - depth_m;
    // The speed is measured over two ticks of the path, as a chord: short by (v T / r)^2 / 6.
    const double bend = speed_m_per_s / rate_hz / r;
    for (const char* name : {"hri", "hri-paper", "blezek"}) {
      const double exact_m = algorithmEntry(name).plane_age_error({.speed_m_per_s = speed_m_per_s,
                                                                   .rate_hz = rate_hz,
                                                                   .n = n,
                                                                   .curvature_per_m = 1 / r,
                                                                   .depth_m = depth_m,
                                                                   .voxel_m = h});
      EXPECT_NEAR(planeAgeError(around(radius_m, depth_m, speed_m_per_s), ball, name, n, rate_hz), exact_m,
                  exact_m * (h * h / (r * r) + bend * bend))
          << i << name;
    }
  }
}

TEST(PlaneAge, OutsideTheObjectNothingAges) {
  EXPECT_EQ(planeAgeError(around(10e-3, -2e-3, 0.5), ballField(10e-3), "hri-paper", 50, 1000), 0);
}

TEST(PlaneAge, IsToldWithTheNThatWouldDo) {
  Scene scene;
  scene.algorithm = "hri-paper";
  scene.plane_renewal_ticks = 50;
  scene.stiffness_N_per_m = 1000;
  const AnalyticField ball = ballField(20e-3);
  const WantedPath path = around(20e-3, 1e-3, 0.2);
  const auto note = noteOnPlaneAge(scene, path, ball);
  ASSERT_TRUE(note);
  EXPECT_THAT(*note, HasSubstr("a plane is kept for up to 50 ticks"));
  std::smatch found;
  ASSERT_TRUE(std::regex_search(*note, found, std::regex("--n ([0-9]+) keeps")));
  scene.plane_renewal_ticks = std::stoi(found[1]);
  EXPECT_FALSE(noteOnPlaneAge(scene, path, ball));
  scene.plane_renewal_ticks += 1;
  EXPECT_TRUE(noteOnPlaneAge(scene, path, ball));
  scene.algorithm = "blezek";  // keeps no planes
  EXPECT_FALSE(noteOnPlaneAge(scene, path, ball));
}

// It renews its planes before they are so wrong that a hand feels it.
TEST(PlaneAge, OfHriIsNotWarnedAboutAtAnyN) {
  Scene scene;
  for (const int n : {50, 1000, 100000}) {
    scene.plane_renewal_ticks = n;
    EXPECT_FALSE(noteOnPlaneAge(scene, around(20e-3, 1e-3, 0.2), ballField(20e-3))) << n;
  }
}

TEST(PlaneAge, WhereNoNWouldDoTheSpeedIsTold) {
  Scene scene;
  scene.plane_renewal_ticks = 1;
  scene.stiffness_N_per_m = 1e5;
  const auto note = noteOnPlaneAge(scene, around(5e-3, 1e-3, 0.4), ballField(5e-3));
  ASSERT_TRUE(note);
  EXPECT_THAT(*note, HasSubstr("move more slowly or raise --rate"));
}

}  // namespace plane_age_test
}  // namespace palpate
