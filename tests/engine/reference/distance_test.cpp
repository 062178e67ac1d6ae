// SPDX-License-Identifier: Apache-2.0
// The twin of the signed distance by its definition; checked against brute force where the kernel is (filter_passes).
#include "engine/reference/distance.hpp"

#include <gtest/gtest.h>

#include "engine/filter/filter_spec.hpp"

namespace palpate::reference {
namespace distance_test {

// A ramp along i of 1 per voxel of 1 mm, through the isovalue 2 at voxel 2 exactly: that voxel lies on the surface and
// is background.
TEST(DistanceTwin, AVoxelAtTheIsovalueIsNotInside) {
  DenseField field{Vec3i(6, 3, 3), {}, {}};
  for (int n = 0; n < field.size.prod(); ++n) field.values.push_back(static_cast<float>(n % 6));
  const std::vector<FilterStep> steps = lowerFilters(filterChain("distance:3"), field.lattice.spacing_m, 2.0F);
  const DenseField distance_m = signedDistance(field, steps);
  for (int k = 0; k < 3; ++k) {
    for (int j = 0; j < 3; ++j) {
      EXPECT_EQ(distance_m.at(2, j, k), 0.0F);
      for (int i = 0; i < 6; ++i) EXPECT_NEAR(distance_m.at(i, j, k), 1e-3 * (i - 2), 1e-9) << i;
    }
  }
}

}  // namespace distance_test
}  // namespace palpate::reference
