// SPDX-License-Identifier: Apache-2.0
// Bricks by number, by place, by what touches them and by what crosses them, against definitions brick by brick.
#include <algorithm>
#include <random>
#include <set>

#include <gtest/gtest.h>

#include "engine/bricks/active_bricks.hpp"
#include "engine/bricks/brick_reach.hpp"

namespace palpate {
namespace bricks_test {

using Bricks = std::vector<std::uint32_t>;

// Volumes of one voxel and more, of whole bricks and not.
std::vector<BrickGrid> grids() {
  std::vector<BrickGrid> all;
  for (const Vec3i& size :
       {Vec3i(1, 1, 1), Vec3i(8, 8, 8), Vec3i(9, 8, 7), Vec3i(40, 17, 33), Vec3i(200, 9, 9), Vec3i(31, 130, 64)})
    all.push_back({size, Vec3::Ones()});
  return all;
}

Vec3i voxelIn(const BrickGrid& grid, std::mt19937& random) {
  const auto below = [&](int end) { return std::uniform_int_distribution(0, end - 1)(random); };
  return {below(grid.size.x()), below(grid.size.y()), below(grid.size.z())};
}

VoxelBox boxIn(const BrickGrid& grid, std::mt19937& random) {
  const Vec3i a = voxelIn(grid, random), b = voxelIn(grid, random);
  return {a.cwiseMin(b), a.cwiseMax(b)};
}

// The farthest apart that two bricks are along an axis.
int apart(const Vec3i& a, const Vec3i& b) {
  return (a - b).cwiseAbs().maxCoeff();
}

TEST(BrickGrid, NumbersEveryBrickOnceInTheOrderOfVisits) {
  for (const BrickGrid& grid : grids()) {
    std::uint32_t next = 0;
    grid.forEach([&](const Vec3i& brick) {
      EXPECT_EQ(grid.index(brick), next);
      EXPECT_EQ(grid.brick(next), brick);
      EXPECT_TRUE(grid.holds(brick));
      const VoxelBox box = grid.box(next++);
      EXPECT_EQ(box.first, Vec3i(brick * kBrickSize));
      EXPECT_EQ(box.last, Vec3i((brick * kBrickSize + Vec3i::Constant(7)).cwiseMin(grid.size - Vec3i::Ones())));
    });
    EXPECT_EQ(next, grid.brickCount());
    EXPECT_FALSE(grid.holds(grid.counts()));
    EXPECT_FALSE(grid.holds({0, -1, 0}));
  }
}

TEST(BrickGrid, VisitsWhatABoxAndWhatABrickTouches) {
  std::mt19937 random(1);
  for (const BrickGrid& grid : grids()) {
    for (int trial = 0; trial < 40; ++trial) {
      const VoxelBox box = boxIn(grid, random);
      const Vec3i middle = voxelIn(grid, random) / kBrickSize;
      const Vec3i ring(trial % 3, trial / 3 % 3, trial / 9 % 3);
      Bricks in, within, around, corner, before, beside;
      grid.forEachIn(box, [&](const Vec3i& brick) { in.push_back(grid.index(brick)); });
      grid.forEachWithin(middle, ring, [&](std::uint32_t brick) { within.push_back(brick); });
      grid.forEachAround(middle, [&](std::uint32_t brick) { around.push_back(brick); });
      grid.forEachAtCorner(middle, 1, [&](std::uint32_t brick) { corner.push_back(brick); });
      grid.forEachAtCorner(middle, -1, [&](std::uint32_t brick) { before.push_back(brick); });
      grid.forEachBeside(middle, [&](std::uint32_t brick) { beside.push_back(brick); });
      Bricks want_in, want_within, want_around, want_corner, want_before, want_beside;
      for (std::uint32_t brick = 0; brick < grid.brickCount(); ++brick) {
        const Vec3i at = grid.brick(brick);
        if (!intersection(grid.box(brick), box).empty()) want_in.push_back(brick);
        if (((at - middle).array().abs() <= ring.array()).all()) want_within.push_back(brick);
        if (apart(at, middle) <= 1) want_around.push_back(brick);
        if (apart(at, middle) <= 1 && (at.array() >= middle.array()).all()) want_corner.push_back(brick);
        if (apart(at, middle) <= 1 && (at.array() <= middle.array()).all()) want_before.push_back(brick);
        if ((at - middle).cwiseAbs().sum() == 1) want_beside.push_back(brick);
      }
      for (Bricks* bricks : {&around, &corner, &before, &beside}) std::sort(bricks->begin(), bricks->end());
      ASSERT_EQ(in, want_in);
      ASSERT_EQ(within, want_within);
      ASSERT_EQ(around, want_around);
      ASSERT_EQ(corner, want_corner);
      ASSERT_EQ(before, want_before);
      ASSERT_EQ(beside, want_beside);
    }
    int visits = 0;
    grid.forEachIn(VoxelBox{}, [&](const Vec3i&) { ++visits; });
    EXPECT_EQ(visits, 0);
  }
}

// Inclusive boxes, cut to a domain of 40 x 17 x 33 voxels; an empty one adds nothing to a hull.
TEST(VoxelBox, IsWidenedInTheDomainAndJoined) {
  const BrickGrid grid{{40, 17, 33}};
  const auto expectBox = [](const VoxelBox& box, const Vec3i& first, const Vec3i& last) {
    EXPECT_EQ(box.first, first);
    EXPECT_EQ(box.last, last);
  };
  expectBox(grid.widened({{5, 6, 7}, {10, 11, 12}}, {1, 2, 3}), {4, 4, 4}, {11, 13, 15});
  expectBox(grid.widened({{2, 3, 4}, {37, 15, 29}}, {3, 4, 5}), {0, 0, 0}, {39, 16, 32});
  const VoxelBox a{{1, 8, 3}, {4, 9, 6}}, b{{2, 5, 1}, {3, 12, 4}};
  expectBox(hull(a, b), {1, 5, 1}, {4, 12, 6});
  expectBox(hull(a, {}), a.first, a.last);
  expectBox(hull({}, b), b.first, b.last);
  expectBox(intersection(a, b), {2, 8, 3}, {3, 9, 4});
  EXPECT_FALSE((VoxelBox{{3, 3, 3}, {3, 3, 3}}.empty()));
}

// A changed voxel c changes results at c - low ... c + high.
TEST(BrickReach, IsEveryBrickWithAResultThatChanges) {
  std::mt19937 random(2);
  for (const BrickGrid& grid : grids()) {
    for (int trial = 0; trial < 40; ++trial) {
      const VoxelBox changed = boxIn(grid, random);
      const Reach reach{static_cast<int>(random() % 12), static_cast<int>(random() % 12)};
      Bricks want, bricks;
      for (std::uint32_t brick = 0; brick < grid.brickCount(); ++brick) {
        const VoxelBox box = grid.box(brick);
        const bool low = ((box.last - changed.first).array() >= -reach.low).all();
        const bool high = ((box.first - changed.last).array() <= reach.high).all();
        if (low && high) want.push_back(brick);
      }
      appendReached(grid, changed, reach, bricks);
      ASSERT_EQ(bricks, want);
      const Bricks once = bricks;
      bricks.insert(bricks.end(), once.rbegin(), once.rend());
      sortUnique(bricks);
      ASSERT_EQ(bricks, once);
    }
  }
}

// Crossed is what has a density at or below the isovalue and one above it.
TEST(ActiveBricks, AreThoseThatAreCrossedAndTheirFarCorners) {
  std::mt19937 random(3);
  for (const BrickGrid& grid : grids()) {
    for (int trial = 0; trial < 30; ++trial) {
      std::vector<layout::BrickBounds> bounds(grid.brickCount());
      for (layout::BrickBounds& one : bounds) {
        one.lowest = static_cast<float>(random() % 20);
        one.highest = one.lowest + static_cast<float>(random() % 3);
      }
      const layout::IsovaluePair isovalues{static_cast<float>(random() % 20), static_cast<float>(random() % 20)};
      const auto wanted = [&](std::initializer_list<float> either) {
        std::set<std::uint32_t> all;
        for (std::uint32_t brick = 0; brick < grid.brickCount(); ++brick) {
          const bool crossed = std::any_of(either.begin(), either.end(), [&](float isovalue) {
            return !(bounds[brick].lowest > isovalue) && bounds[brick].highest > isovalue;
          });
          if (!crossed) continue;
          for (std::uint32_t other = 0; other < grid.brickCount(); ++other) {
            const Vec3i way = grid.brick(other) - grid.brick(brick);
            if (way.minCoeff() >= 0 && way.maxCoeff() <= 1) all.insert(other);
          }
        }
        return Bricks(all.begin(), all.end());
      };
      ASSERT_EQ(activeBricks(bounds, grid, isovalues), wanted({isovalues.felt, isovalues.other}));
      ASSERT_EQ(activeBricks(bounds, grid, isovalues.felt), wanted({isovalues.felt}));
    }
  }
}

// Blocks of 16 bricks along each axis, shifted by half a block: no block is taken up again once it was left.
TEST(ActiveBricks, InBlocksAreTheSameOnesBlockByBlock) {
  std::mt19937 random(4);
  const BrickGrid grid{{400, 300, 200}};
  Bricks some;
  for (const std::uint32_t brick : allBricks(grid))
    if (random() % 3 == 0) some.push_back(brick);
  const Bricks ordered = inBlocks(some, grid);
  std::set<std::array<int, 3>> left;
  std::array<int, 3> block{-1, -1, -1};
  for (const std::uint32_t brick : ordered) {
    const Vec3i at = (grid.brick(brick).array() + 8) / 16;
    const std::array<int, 3> now{at.x(), at.y(), at.z()};
    if (now == block) continue;
    EXPECT_TRUE(left.insert(now).second);
    block = now;
  }
  EXPECT_EQ(left.size(), 4U * 3U * 3U);  // 50 x 38 x 25 bricks, cut at 8, 24 and 40
  Bricks sorted = ordered;
  std::sort(sorted.begin(), sorted.end());
  EXPECT_EQ(sorted, some);
  EXPECT_EQ(allBricks(grid).size(), grid.brickCount());
}

// At the isovalue is background: a field that only touches it from below has no surface.
TEST(ActiveBricks, AtTheIsovalueIsBackground) {
  const std::vector<layout::BrickBounds> touching = {{-1.0F, 0.0F}};
  const std::vector<layout::BrickBounds> crossing = {{0.0F, 1.0F}};
  EXPECT_TRUE(activeBricks(touching, BrickGrid{{8, 8, 8}}, 0.0F).empty());
  EXPECT_EQ(activeBricks(crossing, BrickGrid{{8, 8, 8}}, 0.0F).size(), 1U);
}

// Those of a block lie together, and the middle of the volume is inside one.
TEST(ActiveBricks, InBlocksLieCloserTogether) {
  const BrickGrid grid{{8 * 40, 8 * 33, 8 * 32}};
  const Bricks blocks = inBlocks(allBricks(grid), grid);
  const auto positionOf = [&](int x, int y, int z) {
    return std::find(blocks.begin(), blocks.end(), grid.index({x, y, z})) - blocks.begin();
  };
  // A block holds 4096 bricks; along i, j, k a neighbour in it is at most that far, where in one list it is 1320.
  for (int z = 15; z <= 16; ++z) {
    for (int y = 15; y <= 16; ++y) {
      for (int x = 15; x <= 16; ++x) EXPECT_LT(std::abs(positionOf(x, y, z) - positionOf(15, 15, 15)), 300);
    }
  }
}

}  // namespace bricks_test
}  // namespace palpate
