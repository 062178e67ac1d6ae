// SPDX-License-Identifier: Apache-2.0
// Pictures made by hand of a sphere, whose depth is known by formula.
#include "apps/bench/depth_errors.hpp"

#include <cmath>
#include <limits>

#include <gtest/gtest.h>

namespace palpate {
namespace depth_errors_test {

constexpr double kNowhere = std::numeric_limits<double>::infinity();

struct Scene {
  std::unique_ptr<Phantom> phantom = makePhantom("phantom:sphere?size=64");
  double radius_m = -phantom->signedDistance_m(Vec3::Zero());
  Camera camera = lookAt(Vec3::Zero(), Vec3(0.6, -0.64, 0.48), 0.3, Vec3::UnitZ(), 40, 30, 0.3);

  // How near the ray through a pixel comes to the middle, and where it enters the sphere.
  double closest(int x, int y) const { return camera.position_W.cross(camera.rayThrough(x + 0.5, y + 0.5)).norm(); }
  double entry(int x, int y) const {
    const double along = -camera.position_W.dot(camera.rayThrough(x + 0.5, y + 0.5)), miss = closest(x, y);
    return miss < radius_m ? along - std::sqrt(radius_m * radius_m - miss * miss) : kNowhere;
  }
  RenderedImage exact() const {
    RenderedImage image{40, 30, std::vector<std::uint8_t>(4800), {}};
    for (int y = 0; y < 30; ++y) {
      for (int x = 0; x < 40; ++x) image.distance_m.push_back(static_cast<float>(entry(x, y)));
    }
    return image;
  }
};

// Floats of some 0.3 m are off by 2e-8 m, the exact ray by 1e-4 voxel divided by the cosine at the rim: under 0.01.
TEST(DepthErrors, OfAnExactPictureAreNone) {
  const Scene scene;
  const DepthErrors errors = depthErrors(scene.exact(), scene.camera, *scene.phantom, 1);
  EXPECT_LT(errors.voxel.max, 0.01);
  EXPECT_GT(errors.voxel.count, 150U);
  EXPECT_EQ(errors.holes, 0U);
  EXPECT_EQ(errors.false_hits, 0U);
}

TEST(DepthErrors, AreThoseOfThePixelsThatAreOff) {
  const Scene scene;
  RenderedImage image = scene.exact();
  const double voxel_m = scene.phantom->lattice().smallestSpacing();
  for (float& distance_m : image.distance_m) distance_m += static_cast<float>(0.25 * voxel_m);
  const DepthErrors errors = depthErrors(image, scene.camera, *scene.phantom, 1);
  EXPECT_NEAR(errors.voxel.p50, 0.25, 1e-3);
  EXPECT_NEAR(errors.voxel.max, 0.25, 0.01);
}

TEST(DepthErrors, CountHolesAndFalseHits) {
  const Scene scene;
  const double voxel_m = scene.phantom->lattice().smallestSpacing();
  RenderedImage image = scene.exact();
  std::size_t deep = 0, far = 0, grazing = 0;
  for (int y = 0; y < 30; ++y) {
    for (int x = 0; x < 40; ++x) {
      float& distance_m = image.distance_m[static_cast<std::size_t>(y) * 40 + x];
      const double beyond = scene.closest(x, y) - scene.radius_m;
      deep += beyond < -0.55 * voxel_m;
      far += beyond > 0.55 * voxel_m;
      grazing += std::abs(beyond) < 0.45 * voxel_m;
      distance_m =
          std::isfinite(distance_m) ? std::numeric_limits<float>::infinity() : 0.3F;  // all the wrong way round
    }
  }
  const DepthErrors errors = depthErrors(image, scene.camera, *scene.phantom, 1);
  EXPECT_GT(deep, 150U);
  EXPECT_GT(far, 200U);
  EXPECT_GT(grazing, 0U);
  EXPECT_GE(errors.holes, deep);
  EXPECT_GE(errors.false_hits, far);
  EXPECT_LE(errors.holes + errors.false_hits, 1200 - grazing);  // the rim counts as neither
}

// Every second pixel of every second row: a quarter of them.
TEST(DepthErrors, LookAtEveryPixelOfTheStride) {
  const Scene scene;
  const auto count = [&](int stride) {
    return depthErrors(scene.exact(), scene.camera, *scene.phantom, stride).voxel.count;
  };
  EXPECT_NEAR(static_cast<double>(count(2)) * 4, static_cast<double>(count(1)), 0.1 * static_cast<double>(count(1)));
}

}  // namespace depth_errors_test
}  // namespace palpate
