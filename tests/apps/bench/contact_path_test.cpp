// SPDX-License-Identifier: Apache-2.0
#include "apps/bench/contact_path.hpp"

#include <gtest/gtest.h>

#include "base/error.hpp"

namespace palpate {
namespace contact_path_test {

class ContactPathOf : public testing::TestWithParam<const char*> {};

// The level set is met to 1e-6 voxel; a step of v / rate along the tangent, put back, is at most that long and, where
// the surface has a radius of 3 voxels or more at the tool (the knot's tube), shorter by (step / radius)^2 / 2 < 0.1 %;
// where the heading is replaced for a tick it may be up to half a step longer, and at rest it is zero.
TEST_P(ContactPathOf, LiesOnTheLevelSetAndKeepsItsSpeed) {
  const BenchVolume volume(GetParam());
  const double voxel_m = volume.voxel_m();
  const ContactPath path =
      contactPath(volume, {.speed_m_per_s = 0.1, .rate_hz = 1000, .depth_voxel = 0.8, .ticks = 3000});
  ASSERT_EQ(path.ticks(), 3000U);
  const double step_m = 1e-4;
  std::size_t at_speed = 0, exact = 0;
  for (std::size_t k = path.slide_begin; k < path.ticks(); ++k) {
    EXPECT_NEAR(volume.phantom().signedDistance_m(path.hip_W[k]), -0.8 * voxel_m, 1.1e-6 * voxel_m);
    EXPECT_NEAR(path.depth_m[k], 0.8 * voxel_m, 1.1e-6 * voxel_m);
    EXPECT_GE(volume.borderDistance(path.hip_W[k]), kBorderVoxels);
    exact += path.exact[k] != 0 ? 1 : 0;
    if (k == path.slide_begin) continue;
    const double way_m = (path.hip_W[k] - path.hip_W[k - 1]).norm();
    EXPECT_LE(way_m, 1.5 * step_m);
    EXPECT_NEAR(path.velocity_W[k].norm(), way_m * 1000, 1e-9);
    at_speed += std::abs(way_m - step_m) < 2e-3 * step_m ? 1 : 0;
  }
  const std::size_t slide = path.ticks() - path.slide_begin;
  EXPECT_GE(at_speed, slide * 95 / 100);
  EXPECT_GE(exact, slide * 80 / 100);
}

INSTANTIATE_TEST_SUITE_P(Phantoms, ContactPathOf,
                         testing::Values("phantom:sphere?size=64", "phantom:knot?size=64",
                                         "phantom:head?size=128x128x64", "phantom:lung?size=128x128x64"));

TEST(ContactPath, ComesFromTwoVoxelsOutside) {
  const BenchVolume volume("phantom:sphere?size=64");
  const ContactPath path = contactPath(volume, {.ticks = 100});
  EXPECT_NEAR(path.depth_m.front(), -2e-3, 1e-9);
  ASSERT_EQ(path.slide_begin, 30U);  // 3 mm at 0.1 mm a tick
  for (std::size_t k = 1; k <= path.slide_begin; ++k) {
    EXPECT_NEAR(path.depth_m[k] - path.depth_m[k - 1], 1e-4, 1e-9);
  }
}

TEST(ContactPath, IsTheSameForTheSameSeedOnly) {
  const BenchVolume volume("phantom:sphere?size=32");
  const ContactPathRequest request{.ticks = 200, .seed = 7};
  EXPECT_EQ(contactPath(volume, request).hip_W, contactPath(volume, request).hip_W);
  EXPECT_NE(contactPath(volume, request).hip_W, contactPath(volume, {.ticks = 200, .seed = 8}).hip_W);
}

TEST(ContactPath, RefusesAPhantomWithoutASurface) {
  EXPECT_THROW(static_cast<void>(contactPath(BenchVolume("phantom:random?size=16"), {})), Error);
}

}  // namespace contact_path_test
}  // namespace palpate
