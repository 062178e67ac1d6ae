// SPDX-License-Identifier: Apache-2.0
#include "engine/field/volume.hpp"

#include <cmath>
#include <limits>
#include <random>

#include <fmt/format.h>

#include "tests/engine/files/files.hpp"

namespace palpate {
namespace volume_test {

VolumeFacts facts() {
  VolumeFacts made;
  made.source = "test";
  return made;
}

std::size_t count(const Vec3i& size) {
  return static_cast<std::size_t>(size.prod());
}

// Every voxel another value.
Volume distinctVolume(const Vec3i& size) {
  std::vector<float> values(count(size));
  for (std::size_t n = 0; n < values.size(); ++n) values[n] = static_cast<float>(n);
  return Volume::fromDense(size, plainLattice(), values, facts());
}

TEST(Volume, GivesBackEveryVoxelForSizesThatAreNoMultiplesOfABrick) {
  for (const Vec3i& size : {Vec3i(2, 2, 2), Vec3i(8, 8, 8), Vec3i(9, 7, 17), Vec3i(16, 3, 25)}) {
    const Volume volume = distinctVolume(size);
    const std::vector<float> dense = volume.toDense();
    ASSERT_EQ(dense.size(), count(size));
    for (std::size_t n = 0; n < dense.size(); ++n) ASSERT_EQ(dense[n], static_cast<float>(n));
    EXPECT_EQ(volume.minimum(), 0.0F);
    EXPECT_EQ(volume.maximum(), static_cast<float>(count(size) - 1));
    EXPECT_EQ(volume.brickCount(), Vec3i((size.x() + 7) / 8, (size.y() + 7) / 8, (size.z() + 7) / 8));
  }
}

TEST(Volume, ReadsBricksAsItReadsVoxelsAlsoBeyondTheDomain) {
  const Volume volume = distinctVolume({9, 7, 17});
  std::vector<float> values(kBrickVoxels);
  for (int bk = 0; bk < 3; ++bk) {
    for (int bi = 0; bi < 2; ++bi) {
      ASSERT_FALSE(volume.readBrick({bi, 0, bk}, values.data()));
      for (int n = 0; n < kBrickVoxels; ++n) {
        const Vec3i index(bi * 8 + n % 8, n / 8 % 8, bk * 8 + n / 64);
        ASSERT_EQ(values[static_cast<std::size_t>(n)], volume.value(index)) << index.transpose();
      }
    }
  }
  EXPECT_EQ(volume.value({-5, -5, -5}), 0.0F);
  EXPECT_EQ(volume.value({100, 100, 100}), volume.maximum());
}

TEST(Volume, KeepsNoStorageForConstantBricks) {
  const Vec3i size(24, 16, 12);  // 3 x 2 x 2 bricks, the last ones cut
  std::vector<float> values(count(size), 7.0F);
  values[0] = 8.0F;
  const Volume volume = Volume::fromDense(size, plainLattice(), values, facts());
  EXPECT_EQ(volume.storedBricks(), 1U);
  std::vector<float> brick(kBrickVoxels, -1.0F);
  EXPECT_FALSE(volume.readBrick({0, 0, 0}, brick.data()));
  EXPECT_TRUE(volume.readBrick({2, 1, 1}, brick.data()));
  EXPECT_EQ(brick[0], 7.0F);
  EXPECT_EQ(volume.toDense(), values);
}

// A brick of +0 and -0 is not constant: equal values, other bits.
TEST(Volume, KeepsTheSignOfZeroAndDenormals) {
  std::vector<float> values(512, 0.0F);
  values[5] = -0.0F;
  values[6] = std::numeric_limits<float>::denorm_min();
  const Volume volume = Volume::fromDense({8, 8, 8}, plainLattice(), values, facts());
  const std::vector<float> dense = volume.toDense();
  EXPECT_EQ(std::memcmp(dense.data(), values.data(), values.size() * sizeof(float)), 0);
}

// One voxel that differs from the others of a whole brick, at its beginning, in its middle and at its end.
TEST(Volume, SeesEveryVoxelOfAWholeBrick) {
  std::vector<float> values(512, 5.0F);
  for (std::size_t n = 0; n < 512; ++n) {
    if (n == 16) n = 248;
    if (n == 264) n = 496;
    for (const float value : {7.0F, 3.0F}) {
      values[n] = value;
      const Volume volume = Volume::fromDense({8, 8, 8}, plainLattice(), values, facts());
      EXPECT_EQ(volume.minimum(), std::min(value, 5.0F)) << n;
      EXPECT_EQ(volume.maximum(), std::max(value, 5.0F)) << n;
      EXPECT_EQ(volume.storedBricks(), 1U) << n;
    }
    for (const float value : {std::nanf(""), -std::numeric_limits<float>::infinity()}) {
      values[n] = value;
      expectRefusal(
          [&] {
            static_cast<void>(Volume::fromDense({8, 8, 8}, plainLattice(), values, facts()));
          },
          "test",
          fmt::format("1 of its 512 voxels are NaN or infinite, the first at index ({}, {}, {})", n % 8, n / 8 % 8,
                      n / 64));
    }
    values[n] = 5;
  }
  EXPECT_EQ(Volume::fromDense({8, 8, 8}, plainLattice(), values, facts()).storedBricks(), 0U);
}

// f is linear, so trilinear interpolation and central differences are exact: what is left is the rounding of floats of
// size 2^8 (half an ulp is 2^-17 = 8e-6), and of their differences over 2 h.
TEST(Volume, SamplesLinearFieldsExactly) {
  const Lattice lattice = obliqueLattice();
  const Vec3 slope_L(30, -20, 10);  // [density/voxel]
  std::vector<float> values;
  for (int n = 0; n < 11 * 9 * 6; ++n) {
    const Vec3i voxel(n % 11, n / 11 % 9, n / 99);
    values.push_back(static_cast<float>(5 + slope_L.dot(voxel.cast<double>())));
  }
  const Volume volume = Volume::fromDense({11, 9, 6}, lattice, values, facts());
  const Vec3 gradient_W = lattice.R_WL * slope_L.cwiseQuotient(lattice.spacing_m);
  for (const Vec3& p_L : {Vec3(0.01, 0.01, 0.01), Vec3(3.3, 4.7, 2.2), Vec3(9.99, 7.99, 4.99), Vec3(5, 4, 3)}) {
    double density = 0;
    Vec3 gradient;
    ASSERT_TRUE(volume.sample(lattice.toWorld(p_L), density, gradient));
    EXPECT_NEAR(density, 5 + slope_L.dot(p_L), 1e-5);
    EXPECT_LE((gradient - gradient_W).norm(), 1e-5 * gradient_W.norm());
  }
}

// Binary fractions as spacings, so that nothing is rounded: from the first voxel's centre to the last one's.
TEST(Volume, SamplesUpToItsOutermostVoxels) {
  const Lattice lattice{Vec3::Zero(), Mat3::Identity(), {0.5, 0.25, 2}};
  std::vector<float> values;
  for (int n = 0; n < 3 * 4 * 5; ++n) {
    const int value = 1 + 2 * (n % 3) + 3 * (n / 3 % 4) + 5 * (n / 12);
    values.push_back(static_cast<float>(value));
  }
  const Volume volume = Volume::fromDense({3, 4, 5}, lattice, values, facts());
  double density = 0;
  Vec3 gradient;
  for (const auto& [p_L, want] : {std::pair(Vec3(0, 0, 0), 1.0), std::pair(Vec3(2, 3, 4), 34.0),
                                  std::pair(Vec3(2, 0, 4), 25.0), std::pair(Vec3(0.5, 1.5, 2.25), 17.75)}) {
    ASSERT_TRUE(volume.sample(lattice.toWorld(p_L), density, gradient)) << p_L.transpose();
    EXPECT_EQ(density, want) << p_L.transpose();
    EXPECT_EQ(gradient, Vec3(4, 12, 2.5)) << p_L.transpose();
  }
  for (const Vec3& p_L : {Vec3(2.0001, 3, 4), Vec3(2, 3.0001, 4), Vec3(2, 3, 4.0001), Vec3(0, -0.0001, 0)})
    EXPECT_FALSE(volume.sample(lattice.toWorld(p_L), density, gradient)) << p_L.transpose();
}

// Inside, on faces and outside, in volumes of several bricks and of one voxel along an axis.
TEST(Volume, TheDensityAloneIsThatOfTheSample) {
  std::mt19937 random(5);
  std::uniform_real_distribution<double> place(-0.1, 1.1);
  int inside = 0;
  for (const Vec3i& size : {Vec3i(17, 9, 12), Vec3i(2, 3, 2), Vec3i(1, 9, 9), Vec3i(20, 1, 1)}) {
    const Volume volume = distinctVolume(size);
    for (int n = 0; n < 2000; ++n) {
      Vec3 p_L = (size - Vec3i::Ones()).cast<double>().cwiseProduct(Vec3(place(random), place(random), place(random)));
      if (n % 3 == 0) p_L[n % 9 / 3] = std::round(p_L[n % 9 / 3]);
      const Vec3 p_W = volume.lattice().toWorld(p_L);
      double density = 0;
      Vec3 gradient;
      const bool is_inside = volume.sample(p_W, density, gradient);
      ASSERT_EQ(volume.density(p_W), is_inside ? std::optional(density) : std::nullopt) << p_L.transpose();
      inside += is_inside ? 1 : 0;
    }
  }
  EXPECT_GT(inside, 2000);
  EXPECT_LT(inside, 7000);
}

TEST(Volume, KeepsItsNameAndEveryRemark) {
  Volume volume = distinctVolume({2, 2, 2});
  volume.remark("one");
  EXPECT_EQ(volume.facts().remark, "one");
  volume.remark("two");
  EXPECT_EQ(volume.facts().remark, "one; two");
  volume.rename("other");
  EXPECT_EQ(volume.facts().source, "other");
}

TEST(Volume, DoesNotSampleOutsideTheDomain) {
  const Volume volume = distinctVolume({4, 4, 4});
  double density = 0;
  Vec3 gradient;
  for (const Vec3& p_L : {Vec3(-0.01, 1, 1), Vec3(1, 3.01, 1), Vec3(1, 1, 1e9), Vec3(std::nan(""), 1, 1)}) {
    EXPECT_FALSE(volume.sample(volume.lattice().toWorld(p_L), density, gradient));
  }
}

TEST(Volume, RefusesEmptyVolumes) {
  for (const Vec3i& size : {Vec3i(8, 8, 0), Vec3i(0, 8, 8), Vec3i(8, -1, 8)}) {
    const std::vector<float> values(static_cast<std::size_t>(std::max(size.prod(), 0)));
    expectRefusal([&] { static_cast<void>(Volume::fromDense(size, plainLattice(), values, facts())); }, "test",
                  "voxels: none");
  }
}

// A slice has no slope across itself, and cannot be touched.
TEST(Volume, OfOneVoxelAlongAnAxisIsKeptAndSampledButNotTouched) {
  for (int axis = 0; axis < 3; ++axis) {
    Vec3i size(9, 10, 11);
    size[axis] = 1;
    const Volume volume = distinctVolume(size);
    const Vec3i beside = 3 * Vec3i::Unit((axis + 1) % 3);
    EXPECT_EQ(volume.value(beside + Vec3i::Unit(axis)), volume.value(beside));
    double density = 0;
    Vec3 gradient;
    ASSERT_TRUE(volume.sample(volume.lattice().toWorld(beside.cast<double>()), density, gradient));
    EXPECT_NEAR(density, static_cast<double>(volume.value(beside)), 1e-9);  // the index is rounded
    EXPECT_EQ((volume.lattice().R_WL.transpose() * gradient)[axis], 0);
    EXPECT_TRUE(gradient.allFinite());
    EXPECT_FALSE(volume.sample(volume.lattice().toWorld(0.01 * Vec3::Unit(axis)), density, gradient));
    expectRefusal([&] { checkTouchable(volume); }, "test",
                  fmt::format("it has {} x {} x {} voxels, and a surface needs two along every axis; "
                              "give a volume of more slices",
                              size.x(), size.y(), size.z()));
  }
  EXPECT_NO_THROW(checkTouchable(distinctVolume({2, 2, 2})));
}

TEST(Volume, RefusesAWrongNumberOfValues) {
  expectRefusal(
      [] {
        static_cast<void>(Volume::fromDense({4, 4, 4}, plainLattice(), std::vector<float>(63), facts()));
      },
      "test", "63 values were given for 4 x 4 x 4 voxels; give one value a voxel");
}

TEST(Volume, RefusesValuesThatAreNoNumbersWithTheirCountAndTheFirstsIndex) {
  std::vector<float> values(std::size_t{20} * 10 * 10, 1.0F);
  const auto at = [&](int i, int j, int k) -> float& {
    return values[(static_cast<std::size_t>(k) * 10 + j) * 20 + i];
  };
  at(17, 2, 3) = std::nanf("");  // first in the file, though not in the first brick
  at(1, 9, 3) = std::numeric_limits<float>::infinity();
  expectRefusal(
      [&] {
        static_cast<void>(Volume::fromDense({20, 10, 10}, plainLattice(), values, facts()));
      },
      "test", "2 of its 2000 voxels are NaN or infinite, the first at index (17, 2, 3)");
}

TEST(Volume, RefusesBadLattices) {
  Lattice lattice = plainLattice();
  lattice.spacing_m.y() = 0;
  expectRefusal(
      [&] {
        static_cast<void>(Volume::fromDense({2, 2, 2}, lattice, std::vector<float>(8), facts()));
      },
      "test", "not positive");
  lattice = plainLattice();
  lattice.R_WL(0, 1) = 0.1;
  expectRefusal(
      [&] {
        static_cast<void>(Volume::fromDense({2, 2, 2}, lattice, std::vector<float>(8), facts()));
      },
      "test", "sheared");
}

// 2048^3 voxels with a few stored bricks: neither made nor kept dense. 16.7 million tiles of 8 bytes, and their masks.
TEST(Volume, IsMadeBrickByBrickWithoutBeingDense) {
  const Volume volume = Volume::fromBricks(Vec3i::Constant(2048), {}, {}, [](const Vec3i& brick, float* values) {
    if (brick != Vec3i(100, 7, 255)) {
      values[0] = -1;
      return true;
    }
    for (int i = 0; i < kBrickVoxels; ++i) values[i] = static_cast<float>(i);
    return false;
  });
  EXPECT_EQ(volume.storedBricks(), 1U);
  EXPECT_LE(volume.storedBytes(), std::size_t{200} << 20U);
  EXPECT_EQ(volume.value({803, 58, 2047}), (7 * 8 + 2) * 8 + 3);
  EXPECT_EQ(volume.value({0, 0, 0}), -1);
  EXPECT_EQ(volume.maximum(), 511);
}

TEST(Volume, ChangesBrickByBrick) {
  const Vec3i size(19, 10, 8);
  Volume volume = Volume::fromDense(size, {}, std::vector<float>(std::size_t{19} * 10 * 8, 2.0F), {});
  std::vector<float> values(kBrickVoxels);
  for (int i = 0; i < kBrickVoxels; ++i)
    values[static_cast<std::size_t>(i)] = static_cast<float>(i % 8 + i / 8 % 8 * 100);
  volume.setBrick({1, 0, 0}, values.data());
  EXPECT_EQ(volume.storedBricks(), 1U);
  EXPECT_EQ(volume.value({11, 5, 0}), 503);
  EXPECT_EQ(volume.value({7, 5, 0}), 2);
  EXPECT_EQ(volume.maximum(), 707);
  std::vector<float> read(kBrickVoxels);
  EXPECT_FALSE(volume.readBrick({1, 0, 0}, read.data()));
  EXPECT_EQ(read, values);
  values[9] = -5;
  volume.setBrick({1, 0, 0}, values.data());  // once more, in place of the last
  EXPECT_EQ(volume.storedBricks(), 1U);
  EXPECT_EQ(volume.value({9, 1, 0}), -5);
  EXPECT_EQ(volume.minimum(), -5);
  volume.setConstantBrick({1, 0, 0}, 7);
  EXPECT_EQ(volume.storedBricks(), 0U);
  EXPECT_EQ(volume.value({9, 1, 0}), 7);
  EXPECT_TRUE(volume.readBrick({1, 0, 0}, read.data()));
  EXPECT_EQ(read[0], 7);
  volume.setConstantBrick({2, 1, 0}, -9);
  volume.setConstantBrick({0, 1, 0}, 900);
  EXPECT_EQ(volume.minimum(), -9);
  EXPECT_EQ(volume.maximum(), 900);
}

}  // namespace volume_test
}  // namespace palpate
