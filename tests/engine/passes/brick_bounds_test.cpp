// SPDX-License-Identifier: Apache-2.0
#include "engine/reference/brick_bounds.hpp"

#include <algorithm>

#include <gtest/gtest.h>

#include "engine/passes/active_bricks.hpp"
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
  const auto active = activeBricks(run.bounds, volume.brickCount(), 0.0F);
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
  const auto active = activeBricks(run.bounds, volume.brickCount(), 0.0F);
  // A ball of radius 9 voxels spans at most 4 bricks along an axis, the halo one more.
  EXPECT_LE(active.size(), 5U * 5U * 5U);
  EXPECT_GE(active.size(), 8U);
}

// At the isovalue is background: a field that only touches it from below has no surface.
TEST(ActiveBricks, AtTheIsovalueIsBackground) {
  const std::vector<layout::BrickBounds> touching = {{-1.0F, 0.0F}};
  const std::vector<layout::BrickBounds> crossing = {{0.0F, 1.0F}};
  EXPECT_TRUE(activeBricks(touching, {1, 1, 1}, 0.0F).empty());
  EXPECT_EQ(activeBricks(crossing, {1, 1, 1}, 0.0F).size(), 1U);
}

TEST(ActiveBricks, AllBricksAreAll) {
  EXPECT_EQ(allBricks({3, 4, 5}).size(), 60U);
}

// Every brick once; those of a block lie together, and the middle of the volume is inside one.
TEST(ActiveBricks, InBlocksAreTheSameBricksCloserTogether) {
  const Vec3i counts(40, 33, 32);
  const std::vector<std::uint32_t> all = allBricks(counts);
  const std::vector<std::uint32_t> blocks = inBlocks(all, counts);
  std::vector<std::uint32_t> sorted = blocks;
  std::sort(sorted.begin(), sorted.end());
  EXPECT_EQ(sorted, all);
  const auto positionOf = [&](int x, int y, int z) {
    const auto brick = static_cast<std::uint32_t>((z * counts.y() + y) * counts.x() + x);
    return std::find(blocks.begin(), blocks.end(), brick) - blocks.begin();
  };
  // A block holds 4096 bricks; along i, j, k a neighbour in it is at most that far, where in one list it is 1320.
  for (int z = 15; z <= 16; ++z) {
    for (int y = 15; y <= 16; ++y) {
      for (int x = 15; x <= 16; ++x) EXPECT_LT(std::abs(positionOf(x, y, z) - positionOf(15, 15, 15)), 300);
    }
  }
}

}  // namespace brick_bounds_test
}  // namespace palpate
