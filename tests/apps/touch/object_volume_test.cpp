// SPDX-License-Identifier: Apache-2.0
#include "apps/touch/object_volume.hpp"

#include <numbers>

#include <gtest/gtest.h>

#include "engine/files/volume_file.hpp"

namespace palpate {
namespace object_volume_test {

Lattice lattice() {
  Lattice lattice;
  lattice.spacing_m = {0.5e-3, 1e-3, 2e-3};
  return lattice;
}

// A box of 5 x 9 x 3 voxels across bricks, in a domain that ends inside of bricks: a border brick repeats its last
// voxels outside the domain, and those do not count.
TEST(ObjectVolume, CountsVoxelsOfTheDomainOnly) {
  const Vec3i size(11, 10, 7);
  std::vector<float> values;
  for (int k = 0; k < size.z(); ++k) {
    for (int j = 0; j < size.y(); ++j) {
      for (int i = 0; i < size.x(); ++i) values.push_back(i >= 6 && j >= 1 && k >= 4 ? 2.5F : 2.0F);
    }
  }
  const Volume volume = Volume::fromDense(size, lattice(), values, {});
  EXPECT_NEAR(objectVolume_m3(volume, 2.0), 5 * 9 * 3 * 1e-9, 1e-20);  // at the isovalue is not above it
  EXPECT_EQ(objectVolume_m3(volume, 2.5), 0);
}

TEST(ObjectVolume, OfAConstantVolumeIsAllOrNothing) {
  const Volume volume = Volume::fromBricks({20, 9, 8}, lattice(), {}, [](const Vec3i&, float* values) {
    values[0] = 1;
    return true;
  });
  EXPECT_NEAR(objectVolume_m3(volume, 0), 20 * 9 * 8 * 1e-9, 1e-18);
  EXPECT_EQ(objectVolume_m3(volume, 1), 0);
}

// A ball of 10 voxels' radius has 4189 voxels; a lattice point count of a ball is off by some r^1.5 = 32 at most.
TEST(ObjectVolume, OfABallIsItsFormula) {
  const Vec3i size(32, 32, 32);
  std::vector<float> values;
  for (int n = 0; n < size.prod(); ++n) {
    const Vec3 p(n % 32 - 15.3, n / 32 % 32 - 16.2, n / 1024 - 14.9);
    values.push_back(static_cast<float>(10 - p.norm()));
  }
  const double expected_m3 = 4.0 / 3 * std::numbers::pi * 1000 * 1e-9;
  EXPECT_NEAR(objectVolume_m3(Volume::fromDense(size, lattice(), values, {}), 0), expected_m3, 32e-9);
}

}  // namespace object_volume_test
}  // namespace palpate
