// SPDX-License-Identifier: Apache-2.0
// The nearest voxel across, against every pair of voxels.
#include "engine/reference/nearest_across.hpp"

#include <cmath>
#include <random>

#include <gtest/gtest.h>

namespace palpate::reference {
namespace nearest_across_test {

DenseField randomField(const Vec3i& size, double inside_share, std::mt19937& random) {
  DenseField field{size, {}, std::vector<float>(static_cast<std::size_t>(size.prod()))};
  std::uniform_real_distribution<double> uniform(0, 1);
  for (float& value : field.values) value = uniform(random) < inside_share ? 2 : uniform(random) < 0.5 ? 1 : -1;
  return field;
}

Vec3i voxelAt(const DenseField& field, int n) {
  return {n % field.size.x(), n / field.size.x() % field.size.y(), n / field.size.x() / field.size.y()};
}

// A square is a sum of three products, each of two roundings to float, in two additions: four roundings of 2^-24.
TEST(NearestAcross, IsThatOfAllPairs) {
  std::mt19937 random(11);
  std::uniform_real_distribution<double> length(0.3, 4);
  std::uniform_int_distribution<int> side(1, 12);
  std::uniform_int_distribution<int> reach(0, 9);
  for (int round = 0; round < 60; ++round) {
    const double share = round % 4 == 0 ? 0.001 : round % 4 == 1 ? 0.999 : 0.02;
    const DenseField field = randomField({side(random), side(random), side(random)}, share, random);
    AcrossSearch search{1.0F, Vec3(length(random), length(random), length(random)),
                        Vec3i(reach(random), reach(random), reach(random))};
    int slices = 0;
    search.after_slice = [&] { ++slices; };
    const auto squares = squaresAcross(field, search);
    EXPECT_EQ(slices, field.size.z());
    ASSERT_EQ(squares.size(), field.values.size());
    for (int n = 0; n < field.size.prod(); ++n) {
      double nearest = INFINITY;
      for (int m = 0; m < field.size.prod(); ++m) {
        const Vec3i way = voxelAt(field, m) - voxelAt(field, n);
        if ((way.cwiseAbs().array() > search.reach.array()).any()) continue;
        const bool across = (field.values[static_cast<std::size_t>(n)] > search.isovalue) !=
                            (field.values[static_cast<std::size_t>(m)] > search.isovalue);
        if (across) nearest = std::min(nearest, way.cwiseAbs2().cast<double>().dot(search.edge_square));
      }
      const auto& got = squares[static_cast<std::size_t>(n)];
      ASSERT_EQ(got.has_value(), std::isfinite(nearest)) << round << " voxel " << n;
      if (!got) continue;
      ASSERT_NEAR(*got, nearest, 4 * 0x1p-24 * nearest) << round << " voxel " << n;
    }
  }
}

}  // namespace nearest_across_test
}  // namespace palpate::reference
