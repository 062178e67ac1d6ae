// SPDX-License-Identifier: Apache-2.0
// What each algorithm says of its planes' age, against slides on balls, where the depth is known.
#include "servo/algorithms/plane_age.hpp"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>
#include <gtest/gtest.h>

#include "ball_slide.hpp"
#include "servo/algorithms/hri.hpp"
#include "support/algorithm_setups.hpp"
#include "support/seeded.hpp"

namespace palpate {
namespace plane_age_test {

struct Slide {
  double radius_m, depth_m, speed_m_per_s, rate_hz;
  int n;

  [[nodiscard]] PlaneAge age() const {
    return {.speed_m_per_s = speed_m_per_s,
            .rate_hz = rate_hz,
            .n = n,
            .curvature_per_m = 1 / (radius_m - depth_m),
            .depth_m = depth_m,
            .voxel_m = kVoxel};
  }
  // Trilinear interpolation between samples of the distance is off by h^2 / (4 R), at a radius that is h less at most.
  [[nodiscard]] double sampled() const { return kVoxel * kVoxel / (4 * (radius_m - kVoxel)); }
};

Slide anySlide(Seeded& random) {
  const double radius_m = random.between(8e-3, 24e-3);
  return {.radius_m = radius_m,
          .depth_m = random.logBetween(0.1e-3, std::min(6e-3, 0.4 * radius_m)),
          .speed_m_per_s = random.logBetween(0.01, 1),
          .rate_hz = random.logBetween(500, 4000),
          .n = static_cast<int>(std::lround(random.logBetween(1, 2000)))};
}

// The largest error of the depth once the plane has been renewed a few times, or over a radian and a half.
double worstOffDepth(std::string_view name, const Slide& slide) {
  const AnalyticVolume volume = millimetreVolume(ball(kCentre, slide.radius_m));
  const auto algorithm = makeFor(
      name, {.stiffness_N_per_m = 500, .damping_Ns_per_m = 0, .plane_renewal_ticks = slide.n, .rate_hz = slide.rate_hz},
      volume, 4e-3);
  AlgorithmDriver driver(*algorithm, volume, slidePoint(0, slide.radius_m + 1e-3), 32, slide.rate_hz);
  driver.around_vhip = true;
  const double r = slide.radius_m - slide.depth_m;
  driver.stroke(slidePoint(0, r), 40);
  const double step = slide.speed_m_per_s / slide.rate_hz / r;
  const int ticks = static_cast<int>(std::min(1.5 / step, 6000.0));
  double worst_m = 0;
  for (int i = 1; i <= ticks; ++i) {
    const TickOutput out = driver.at(slidePoint(i * step, r));
    if (!out.in_contact) ADD_FAILURE() << name << " lost the contact at tick " << i;
    worst_m = std::max(worst_m, std::abs(out.depth_m - slide.depth_m));
  }
  return worst_m;
}

// The planes lie within SurfaceTracker's tolerance of the line through the tool: so much longer is the way from there.
constexpr double kAside_m = 0.05 * kVoxel;

TEST(PlaneAge, IsABoundOfTheErrorAndNoMoreThanFourTimesIt) {
  Seeded random(61);
  int old = 0;
  for (int i = 0; i < 120; ++i) {
    const Slide slide = anySlide(random);
    const PlaneAge age = slide.age();
    for (const char* name : {"hri", "hri-paper", "hri-paper-line"}) {
      const double bound_m = algorithmEntry(name).plane_age_error(age);
      const double way_m = std::sqrt(2 * bound_m / age.curvature_per_m);
      if (way_m > 0.3 * slide.radius_m) continue;  // the sag's next term is more than a percent
      SCOPED_TRACE(fmt::format("{} {}: R {:.4f} D {:.5f} m, {:.3f} m/s, n {} at {:.0f} Hz", i, name, slide.radius_m,
                               slide.depth_m, slide.speed_m_per_s, slide.n, slide.rate_hz));
      const double worst_m = worstOffDepth(name, slide);
      EXPECT_LE(worst_m, 1.01 * age.sag(way_m + kAside_m) + slide.sampled());
      // hri puts a plane a third of its life ahead: its last tick is 2/3 (n - 1) ticks away, squared 0.28 of n from
      // n = 5 on.
      if (slide.n < 5) continue;
      ++old;
      EXPECT_LE(bound_m, 4 * (worst_m + slide.sampled()));
    }
  }
  EXPECT_GT(old, 100);
}

// At n = 1000 and 100000 as at 100: hri renews a plane when it is a twentieth of the depth off.
TEST(PlaneAge, OfHriEndsWhereThePlaneIsRenewedEarly) {
  Slide slide{.radius_m = 20e-3, .depth_m = 2e-3, .speed_m_per_s = 0.1, .rate_hz = 1000, .n = 1000};
  for (const int n : {1000, 100000}) {
    slide.n = n;
    EXPECT_LE(algorithmEntry("hri").plane_age_error(slide.age()), HriSurface::kMostOff * slide.depth_m * (1 + 1e-12));
    EXPECT_GT(algorithmEntry("hri-paper").plane_age_error(slide.age()), 0.2);
  }
}

TEST(PlaneAge, OfAnAlgorithmWithoutPlanesIsNone) {
  const Slide slide{.radius_m = 20e-3, .depth_m = 2e-3, .speed_m_per_s = 0.1, .rate_hz = 1000, .n = 100};
  for (const AlgorithmEntry& entry : algorithms())
    EXPECT_EQ(entry.plane_age_error(slide.age()) > 0, entry.traits.renews_planes) << entry.name;
}

}  // namespace plane_age_test
}  // namespace palpate
