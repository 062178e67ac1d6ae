// SPDX-License-Identifier: Apache-2.0
#include "engine/reference/brick_bounds.hpp"

#include <algorithm>

#include <gtest/gtest.h>

#include "engine/bricks/active_bricks.hpp"
#include "engine/passes/brick_bounds_pass.hpp"
#include "test_fields.hpp"

namespace palpate {
namespace brick_bounds_test {

struct Computed {
  gpu::Gpu gpu{{}};
  gpu::Transfer transfer{gpu};
  BrickPool pool;
  BrickBoundsPass pass;
  std::vector<layout::BrickBounds> bounds;

  explicit Computed(const Volume& volume) : pool(gpu, transfer, volume), pass(gpu, pool) {
    pass.run();
    bounds = pass.read(transfer);
  }
};

class BrickBounds : public testing::TestWithParam<Vec3i> {};

TEST_P(BrickBounds, EqualTheTwin) {
  const Volume volume = ballField(GetParam(), 9.0);
  const Computed run(volume);
  const reference::DenseField field = reference::denseField(volume);
  std::size_t index = 0;
  for (int z = 0; z < volume.brickCount().z(); ++z) {
    for (int y = 0; y < volume.brickCount().y(); ++y) {
      for (int x = 0; x < volume.brickCount().x(); ++x, ++index) {
        const reference::Bounds expected = reference::brickBounds(field, {x, y, z});
        EXPECT_EQ(run.bounds[index].lowest, expected.lowest) << x << ' ' << y << ' ' << z;
        EXPECT_EQ(run.bounds[index].highest, expected.highest) << x << ' ' << y << ' ' << z;
      }
    }
  }
}

// Whatever cell the surface crosses, its eight corners have gradients; and a ball leaves most bricks alone.
TEST_P(BrickBounds, EveryCrossedCellIsActive) {
  const Volume volume = ballField(GetParam(), 9.0);
  const Computed run(volume);
  const auto active = activeBricks(run.bounds, BrickGrid{volume.size()}, 0.0F);
  for (const std::size_t needed : reference::bricksOfCrossedCells(reference::denseField(volume), 0.0F)) {
    EXPECT_TRUE(std::binary_search(active.begin(), active.end(), needed)) << "brick " << needed;
  }
}

INSTANTIATE_TEST_SUITE_P(Sizes, BrickBounds,
                         testing::Values(Vec3i(41, 33, 37), Vec3i(8, 8, 8), Vec3i(2, 19, 3), Vec3i(19, 1, 3),
                                         Vec3i(17, 16, 15)));

TEST(ActiveBricks, LeaveOutWhatTheSurfaceDoesNotNeed) {
  const Volume volume = ballField({96, 96, 96}, 9.0);
  const Computed run(volume);
  const auto active = activeBricks(run.bounds, BrickGrid{volume.size()}, 0.0F);
  // A ball of radius 9 voxels spans at most 4 bricks along an axis, the halo one more.
  EXPECT_LE(active.size(), 5U * 5U * 5U);
  EXPECT_GE(active.size(), 8U);
}

}  // namespace brick_bounds_test
}  // namespace palpate
