// SPDX-License-Identifier: Apache-2.0
#include "servo/devices/path.hpp"

#include <cmath>

#include <gtest/gtest.h>

#include "base/error.hpp"

namespace palpate {
namespace path_test {

using Interpolation = SampledPath::Interpolation;

TEST(SampledPath, RefusesWhatIsNoPath) {
  const Vec3 p = Vec3::Zero();
  const auto refused = [](std::vector<double> times_s, std::vector<Vec3> points_W) {
    EXPECT_THROW(SampledPath(times_s, points_W, Interpolation::kLinear), Error);
    EXPECT_THROW(SampledPath(times_s, points_W, Interpolation::kCubic), Error);
  };
  refused({}, {});
  refused({0, 1}, {p});
  refused({0, 0}, {p, p});
  refused({0, 1, 0.5}, {p, p, p});
  refused({0, NAN}, {p, p});
  refused({0, 1}, {p, Vec3(0, INFINITY, 0)});
}

TEST(SampledPath, GoesThroughItsPointsAndRestsAtItsEnds) {
  const std::vector<double> times_s = {2.0, 2.1, 2.5, 2.6};
  const std::vector<Vec3> points_W = {{0, 0, 0}, {1, 2, 0}, {3, 2, -1}, {0, 0, 5}};
  for (const Interpolation interpolation : {Interpolation::kLinear, Interpolation::kCubic}) {
    const SampledPath path(times_s, points_W, interpolation);
    EXPECT_DOUBLE_EQ(path.duration_s(), 0.6000000000000001);
    for (std::size_t i = 0; i < points_W.size(); ++i) {
      EXPECT_LT((path.position(times_s[i] - 2.0) - points_W[i]).norm(), 1e-12);
    }
    EXPECT_EQ(path.position(-1), points_W.front());
    EXPECT_EQ(path.position(9), points_W.back());
    EXPECT_EQ(path.position(NAN), points_W.front());
  }
}

TEST(SampledPath, OnePointIsAPlace) {
  const SampledPath path({5}, {Vec3(1, 2, 3)}, Interpolation::kCubic);
  EXPECT_EQ(path.position(0), Vec3(1, 2, 3));
  EXPECT_EQ(path.duration_s(), 0);
}

TEST(SampledPath, LinearIsStraight) {
  const SampledPath path({0, 2}, {Vec3(0, 0, 0), Vec3(4, -2, 1)}, Interpolation::kLinear);
  EXPECT_LT((path.position(0.5) - Vec3(1, -0.5, 0.25)).norm(), 1e-15);
}

// A parabola over uneven times: met exactly between inner points, where both tangents are its own.
TEST(SampledPath, CubicReproducesAParabola) {
  const auto parabola = [](double t) { return Vec3(1 + 2 * t - 3 * t * t, t * t, -t); };
  std::vector<double> times_s;
  std::vector<Vec3> points_W;
  for (double t : {0.0, 0.3, 0.4, 0.9, 1.0, 1.6}) {
    times_s.push_back(t);
    points_W.push_back(parabola(t));
  }
  const SampledPath path(times_s, points_W, Interpolation::kCubic);
  for (double t = 0.3; t <= 1.0; t += 0.01) EXPECT_LT((path.position(t) - parabola(t)).norm(), 1e-14);
}

// At its ends the slope is the chord's. Half-way along a piece from a to b a cubic is (a + b) / 2 + (slope at a - slope
// at b) * span / 8. Of t^2 at 0, 0.3, 0.4, 1 and 1.6 s: 0.045 + (0.3 - 0.6) * 0.3 / 8, and 1.78 + (2 - 2.6) * 0.6 / 8.
TEST(SampledPath, CubicBeginsAndEndsAlongItsChords) {
  std::vector<Vec3> points_W;
  for (const double t : {0.0, 0.3, 0.4, 1.0, 1.6}) points_W.push_back(Vec3(0, t * t, 0));
  const SampledPath path({0, 0.3, 0.4, 1.0, 1.6}, points_W, Interpolation::kCubic);
  EXPECT_NEAR(path.position(0.15).y(), 0.03375, 1e-15);
  EXPECT_NEAR(path.position(1.3).y(), 1.735, 1e-15);
}

// The slope from the left meets that from the right, up to the step's first order: the path's second derivative is
// below 300 m/s^2 here, so 2e-6 s on each side differ by at most 1.2e-3 m/s. A linear path jumps by metres per second.
TEST(SampledPath, CubicHasNoCorners) {
  const SampledPath path({0, 0.1, 0.5, 0.6}, {Vec3(0, 0, 0), Vec3(1, 2, 0), Vec3(3, 2, -1), Vec3(0, 0, 1)},
                         Interpolation::kCubic);
  constexpr double kStep_s = 2e-6;
  for (double t : {0.1, 0.5}) {
    const Vec3 left = (path.position(t) - path.position(t - kStep_s)) / kStep_s;
    const Vec3 right = (path.position(t + kStep_s) - path.position(t)) / kStep_s;
    EXPECT_LT((left - right).norm(), 5e-3);
  }
}

}  // namespace path_test
}  // namespace palpate
