// SPDX-License-Identifier: Apache-2.0
#include "apps/study/shrinking_ball.hpp"

#include <cmath>

#include <gtest/gtest.h>

#include "servo/window/sample_window.hpp"

namespace palpate {
namespace shrinking_ball_test {

// Each sample from the formula: the density at its place, and the differences of its neighbours' densities.
TEST(ShrinkingBall, AWindowShowsTheBallAsItIsThen) {
  const ShrinkingBall ball;
  const Vec3 place_W(0.012, -0.011, 0.0093);
  for (const int edge : {12, 32}) {
    for (const double t_s : {0.0, 0.37}) {
      std::vector<Sample> storage;
      const SampleWindow window = windowOf(ball, t_s, place_W, edge, 7, storage);
      ASSERT_TRUE(window.usable());
      EXPECT_EQ(window.version, 7U);
      EXPECT_EQ(window.edit_version, 7U);
      EXPECT_EQ(window.size, Vec3i::Constant(edge));
      // The place is within a voxel of the window's middle.
      const Vec3 middle_W = window.lattice.toWorld(Vec3::Constant(0.5 * (edge - 1)));
      EXPECT_LE((middle_W - place_W).cwiseAbs().maxCoeff(), 0.5 * ball.voxel_m + 1e-12);
      const auto density = [&](const Vec3& p_W) {
        const double distance_voxel = (p_W.norm() - (20e-3 - 10e-3 * t_s)) / 0.5e-3;
        return static_cast<float>(std::clamp(-1000 / 3.0 * distance_voxel, -1000.0, 1000.0));
      };
      for (int n = 0; n < edge; ++n) {
        const Vec3i at(n, (5 * n + 3) % edge, (7 * n + 1) % edge);
        const Sample& sample = window.samples[(static_cast<std::size_t>(at.z()) * edge + at.y()) * edge + at.x()];
        const Vec3 p_W = window.lattice.toWorld(at.cast<double>());
        EXPECT_NEAR(sample.density, density(p_W), 1e-3);  // of 1000: rounding of the place and to float
        const auto difference = [&](int axis) {
          const Vec3 step_W = 0.5e-3 * Vec3::Unit(axis);
          return (density(p_W + step_W) - density(p_W - step_W)) / 1e-3F;
        };
        EXPECT_NEAR(sample.gradient_i, difference(0), 2);  // of 1e6
        EXPECT_NEAR(sample.gradient_j, difference(1), 2);
        EXPECT_NEAR(sample.gradient_k, difference(2), 2);
      }
    }
  }
}

TEST(BallTool, ComesInAndStaysAtItsDepthBelowTheSurfaceAsItIs) {
  const ShrinkingBall ball;
  const BallTool tool{.speed_m_per_s = 0.5};
  EXPECT_NEAR(tool.towards.norm(), 1, 1e-12);
  EXPECT_NEAR(tool.aside.norm(), 1, 1e-12);
  EXPECT_NEAR(tool.towards.dot(tool.aside), 0, 1e-12);
  EXPECT_NEAR(tool.depthAt_m(0), -1.5e-3, 1e-15);
  for (const double t_s : {0.1, 0.4, 0.9}) {
    EXPECT_NEAR(tool.depthAt_m(t_s), 1e-3, 1e-15);
    EXPECT_NEAR(tool.positionAt_W(ball, t_s).norm(), ball.radiusAt_m(t_s) - 1e-3, 1e-12);
    EXPECT_NEAR(tool.directionAt(ball, t_s).norm(), 1, 1e-12);
  }
  // It slides at its speed over the ball as it was at first.
  const double angle_rad = std::acos(tool.directionAt(ball, 0.2).dot(tool.directionAt(ball, 0.201)));
  EXPECT_NEAR(angle_rad, 0.5 * 1e-3 / 20e-3, 1e-6);
}

}  // namespace shrinking_ball_test
}  // namespace palpate
