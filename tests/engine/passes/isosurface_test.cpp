// SPDX-License-Identifier: Apache-2.0
// The picture's depth against the twin that skips nothing, and against the sphere's formula.
#include "engine/reference/isosurface.hpp"

#include <cmath>
#include <functional>

#include <gtest/gtest.h>

#include "engine/passes/isosurface_pass.hpp"
#include "test_fields.hpp"

namespace palpate {
namespace isosurface_test {

RenderedImage drawFrom(const Volume& volume, const Camera& camera, double isovalue,
                       const std::function<void()>& between = {}) {
  gpu::Gpu gpu({});
  gpu::Transfer transfer(gpu);
  const BrickPool pool(gpu, transfer, volume);
  BrickBoundsPass bounds(gpu, pool);
  bounds.run();
  return IsosurfacePass(gpu, transfer, pool, bounds).draw(camera, isovalue, between);
}

Vec3 middleOf(const Volume& volume) {
  return volume.lattice().toWorld((volume.size().cast<double>().array() - 1) / 2);
}

Camera cameraAt(const Vec3& eye_W, const Vec3& target_W) {
  Camera camera;
  camera.position_W = eye_W;
  camera.forward_W = (target_W - eye_W).normalized();
  camera.right_W = camera.forward_W.cross(Vec3::UnitZ()).normalized();
  camera.up_W = camera.right_W.cross(camera.forward_W);
  camera.vertical_fov_rad = 0.35;
  camera.width = 61;
  camera.height = 47;
  return camera;
}

struct Compared {
  int hits = 0, disagreements = 0;
};

// Each pixel against the twin along its own ray. The marcher steps half a voxel and halves six times: 1/128 voxel; a
// float position at 0.1 m adds 1e-8 m. The twin is exact to 1e-9. At grazing rays a half-voxel step may pass over a
// sliver that the twin's finer step finds: disagreements, of the silhouette alone.
Compared compareWithTwin(const Volume& volume, const Camera& camera, const RenderedImage& image) {
  const reference::DenseField field = reference::denseField(volume);
  const double tolerance_m = volume.lattice().spacing_m.maxCoeff() / 128 + 1e-7;
  Compared compared;
  for (int y = 0; y < camera.height; ++y) {
    for (int x = 0; x < camera.width; ++x) {
      const auto expected =
          reference::firstHit(field, 0.0, camera.position_W, camera.rayThrough(x + 0.5, y + 0.5), 0.1);
      const std::size_t pixel =
          static_cast<std::size_t>(y) * static_cast<std::size_t>(camera.width) + static_cast<std::size_t>(x);
      const bool hit = std::isfinite(image.distance_m[pixel]);
      EXPECT_EQ(image.rgba[4 * pixel + 3], hit ? 255U : 0U);
      if (hit != expected.has_value()) {
        ++compared.disagreements;
      } else if (hit) {
        ++compared.hits;
        EXPECT_NEAR(image.distance_m[pixel], *expected, tolerance_m) << x << ' ' << y;
      }
    }
  }
  return compared;
}

TEST(Isosurface, DepthEqualsTheTwin) {
  const Volume volume = ballField({53, 41, 37}, 14.0);
  const Camera camera = cameraAt(middleOf(volume) + Vec3(0.05, -0.09, 0.04), middleOf(volume));
  const Compared compared = compareWithTwin(volume, camera, drawFrom(volume, camera, 0.0));
  EXPECT_GT(compared.hits, 300);
  EXPECT_LE(compared.disagreements, compared.hits / 50);
}

// 150 rows are two bands of 64 and one of 22. Each shows what its own rays meet.
TEST(Isosurface, ATallPictureIsDrawnInBandsThatMeet) {
  const Volume volume = ballField({53, 41, 37}, 14.0);
  Camera camera = cameraAt(middleOf(volume) + Vec3(0.05, -0.09, 0.04), middleOf(volume));
  camera.width = 3;
  camera.height = 150;
  int bands = 0;
  const RenderedImage image = drawFrom(volume, camera, 0.0, [&] { ++bands; });
  EXPECT_EQ(bands, 3);
  ASSERT_EQ(image.distance_m.size(), 450U);
  ASSERT_EQ(image.rgba.size(), 1800U);
  const Compared compared = compareWithTwin(volume, camera, image);
  EXPECT_GT(compared.hits, 200);
  EXPECT_LE(compared.disagreements, 6);
}

// The field is linear in the distance from the middle [voxel], so along i the surface is 14 voxels out; trilinear
// interpolation of a distance sags by at most h^2/(8R) a dimension: 3/(8*14) = 0.027 voxel.
TEST(Isosurface, MeetsASphereWhereItIs) {
  const Volume volume = ballField({53, 41, 37}, 14.0);
  const Vec3 eye = middleOf(volume) + Vec3(0.08, 0, 0);
  Camera camera = cameraAt(eye, middleOf(volume));
  const RenderedImage image = drawFrom(volume, camera, 0.0);
  const double h = volume.lattice().spacing_m.x();
  EXPECT_NEAR(image.distance_m[static_cast<std::size_t>(23) * 61 + 30], 0.08 - 14 * h, (0.027 + 1.0 / 128) * h);
}

// An object that fills the volume is seen as its cut faces, with the face's depth.
TEST(Isosurface, ShowsTheCutFaceOfAnObjectThatFillsTheVolume) {
  const Volume volume =
      makeField({20, 20, 20}, [](int i, int j, int k) { return static_cast<float>(10 + (i + j + k) % 3); });
  const Vec3 eye = middleOf(volume) + Vec3(0.08, 0, 0);
  const RenderedImage image = drawFrom(volume, cameraAt(eye, middleOf(volume)), 0.0);
  const double half_m = 9.5 * volume.lattice().spacing_m.x();
  EXPECT_NEAR(image.distance_m[static_cast<std::size_t>(23) * 61 + 30], 0.08 - half_m, 1e-6);
}

TEST(Isosurface, SeesNothingWhereThereIsNothing) {
  const Volume volume = ballField({24, 24, 24}, 6.0);
  const RenderedImage image = drawFrom(volume, cameraAt(middleOf(volume) + Vec3(0.08, 0, 0), middleOf(volume)), 100.0);
  for (const float depth : image.distance_m) EXPECT_TRUE(std::isinf(depth));
}

}  // namespace isosurface_test
}  // namespace palpate
