// SPDX-License-Identifier: Apache-2.0
// The cell tree against a loop over all cells: after building it, and after changes.
#include "engine/draw/cell_tree.hpp"

#include <random>
#include <vector>

#include <gtest/gtest.h>

#include "engine/bricks/brick_reach.hpp"
#include "engine/passes/pool_volume.hpp"
#include "engine/reference/dense_field.hpp"
#include "tests/engine/passes/test_fields.hpp"

namespace palpate {
namespace cell_tree_test {

// The tree on the host.
struct Words {
  layout::PoolDomain domain;
  std::vector<std::uint32_t> tree, blocks;
};

Words read(gpu::Transfer& transfer, const BrickPool& pool, const CellTree& tree) {
  Words words{pool.domain(), std::vector<std::uint32_t>(tree.tree().bytes() / 4),
              std::vector<std::uint32_t>(tree.blocks().bytes() / 4)};
  transfer.download(tree.tree(), std::as_writable_bytes(std::span(words.tree)));
  transfer.download(tree.blocks(), std::as_writable_bytes(std::span(words.blocks)));
  return words;
}

bool bitOf(const std::vector<std::uint32_t>& words, std::size_t first, const Vec3i& place) {
  const unsigned bit = static_cast<unsigned>((place.z() & 3) * 16 + (place.y() & 3) * 4 + (place.x() & 3));
  return (words[first + bit / 32] >> (bit % 32) & 1U) != 0;
}

// Of a node of a level, the bit of its child: a brick at level 1.
bool nodeBit(const Words& words, std::uint32_t level, const Vec3i& child) {
  const auto along = [&](layout::uint bricks) { return static_cast<int>(layout::cellNodesAlong(bricks, level)); };
  const Vec3i node = child / 4;
  const int linear = (node.z() * along(words.domain.bricks_y) + node.y()) * along(words.domain.bricks_x) + node.x();
  return bitOf(words.tree, layout::cellLevelBegin(words.domain, level) + 2 * static_cast<std::size_t>(linear), child);
}

bool cellBit(const Words& words, const BrickGrid& grid, const Vec3i& cell) {
  const std::uint32_t slot = words.tree[1 + grid.index(cell / 8)];
  const Vec3i block = cell / 4;
  const auto number = static_cast<std::size_t>((block.z() & 1) * 4 + (block.y() & 1) * 2 + (block.x() & 1));
  return bitOf(words.blocks, std::size_t{slot} * 16 + 2 * number, cell);
}

bool crossed(const reference::DenseField& field, float isovalue, const Vec3i& cell) {
  int inside = 0;
  for (int corner = 0; corner < 8; ++corner)
    inside += field.at(cell.x() + (corner & 1), cell.y() + (corner >> 1 & 1), cell.z() + (corner >> 2)) > isovalue;
  return inside > 0 && inside < 8;
}

// Every bit of every level. Returns how many cells are crossed.
int expectTrue(const Words& words, const reference::DenseField& field, float isovalue, std::uint32_t levels) {
  const BrickGrid grid{field.size, Vec3::Ones()};
  const Vec3i cells = field.size - Vec3i::Ones();
  std::vector<std::vector<bool>> any(levels + 1);  // of each level's children
  const auto childAt = [&](std::uint32_t level, const Vec3i& cell) -> Vec3i { return cell / (8 << (2 * (level - 1))); };
  const auto linear = [](const Vec3i& at) { return (static_cast<std::size_t>(at.z()) * 256 + at.y()) * 256 + at.x(); };
  for (std::uint32_t level = 1; level <= levels; ++level) any[level].resize(std::size_t{1} << 24U);
  int wrong = 0, of_surface = 0;
  for (int z = 0; z < cells.z(); ++z) {
    for (int y = 0; y < cells.y(); ++y) {
      for (int x = 0; x < cells.x(); ++x) {
        const Vec3i cell(x, y, z);
        const bool is_crossed = crossed(field, isovalue, cell);
        of_surface += is_crossed;
        if (is_crossed) {
          for (std::uint32_t level = 1; level <= levels; ++level) any[level][linear(childAt(level, cell))] = true;
        }
        if (nodeBit(words, 1, cell / 8)) wrong += cellBit(words, grid, cell) != is_crossed;
      }
    }
  }
  for (std::uint32_t level = 1; level <= levels; ++level) {
    const Vec3i last = childAt(level, cells - Vec3i::Ones());
    for (int z = 0; z <= last.z(); ++z) {
      for (int y = 0; y <= last.y(); ++y) {
        for (int x = 0; x <= last.x(); ++x) wrong += nodeBit(words, level, {x, y, z}) != any[level][linear({x, y, z})];
      }
    }
  }
  EXPECT_EQ(wrong, 0);
  return of_surface;
}

int expectTreeOf(const Volume& volume, float isovalue) {
  gpu::Gpu gpu({});
  gpu::Transfer transfer(gpu);
  const BrickPool pool(gpu, transfer, volume);
  BrickBoundsPass bounds(gpu, pool);
  bounds.run();
  const CellTree tree(gpu, transfer, pool, bounds, isovalue);
  return expectTrue(read(transfer, pool, tree), reference::denseField(volume), isovalue, tree.levels());
}

TEST(CellTree, KnowsEveryCellOfABall) {
  EXPECT_GT(expectTreeOf(ballField({53, 41, 37}, 14.0), 0),
            2463);  // its area is 4 pi 14^2 = 2463 faces of cells
}

// Sizes around the edges of blocks and bricks, integers as densities, so that many corners lie at the isovalue.
TEST(CellTree, KnowsEveryCellOfNoise) {
  std::mt19937 random(3);
  for (const Vec3i& size : {Vec3i(2, 2, 2), Vec3i(3, 5, 9), Vec3i(8, 9, 10), Vec3i(16, 4, 33), Vec3i(17, 12, 5)}) {
    SCOPED_TRACE(size.transpose());
    const Volume volume =
        makeField(size, [&](int, int, int) { return static_cast<float>(static_cast<int>(random() % 5) - 2); });
    int crossed = 0;
    for (const float isovalue : {-1.0F, 0.0F, 0.5F, 1.0F}) crossed += expectTreeOf(volume, isovalue);
    EXPECT_GT(crossed, 0);
  }
}

// Longer than two nodes of level 1 (64 voxels), so that there are levels above it.
TEST(CellTree, KnowsLongVolumes) {
  const Volume volume = makeField({300, 5, 70}, [](int i, int, int k) {
    return static_cast<float>((i - 200) * (i - 200) + (k - 60) * (k - 60) < 20 || i + k < 3 ? 1 : -1);
  });
  EXPECT_GT(expectTreeOf(volume, 0), 10);
}

// Bricks take other densities, one after another: the tree of the same buffers is that of a new start.
TEST(CellTree, FollowsChanges) {
  gpu::Gpu gpu({});
  gpu::Transfer transfer(gpu);
  const Vec3i size(70, 30, 20);
  std::mt19937 random(8);
  Volume volume = makeField(size, [](int i, int j, int) { return (i + j) % 3 == 0 ? -1.0F : 1.0F; });
  BrickPool pool(gpu, transfer, volume);
  BrickBoundsPass bounds(gpu, pool);
  bounds.run();
  CellTree tree(gpu, transfer, pool, bounds, 0);
  gpu::Commands commands(gpu, "changes", CellTree::kMostDispatches);
  for (int trial = 0; trial < 12; ++trial) {
    std::vector<std::uint32_t> stored, reached;
    for (std::uint32_t brick = 0; brick < pool.brickCount(); ++brick) {
      if (pool.isStored(brick) && random() % 2 == 0) stored.push_back(brick);
    }
    ASSERT_FALSE(stored.empty());
    for (const std::uint32_t brick : stored) {
      const bool one_value = random() % 3 == 0;
      std::vector<float> values(kBrickVoxels);
      for (float& value : values) value = one_value ? 1.0F : static_cast<float>(static_cast<int>(random() % 3) - 1);
      const BrickPool::Place place = BrickPool::place(pool.page(brick).slot);
      transfer.upload(std::as_bytes(std::span(values)), pool.slab(place.slab), place.offset_bytes);
      appendReached(pool.grid(), pool.grid().box(brick), kBoundsReach, reached);
    }
    sortUnique(reached);
    bounds.run();
    tree.reserve(reached.size());
    commands.begin();
    tree.record(commands, reached);
    commands.run();
    const CellTree anew(gpu, transfer, pool, bounds, 0);
    EXPECT_GT(
        expectTrue(read(transfer, pool, tree), reference::denseField(volumeOf(pool, transfer, {})), 0, tree.levels()),
        0);
    EXPECT_EQ(
        expectTrue(read(transfer, pool, anew), reference::denseField(volumeOf(pool, transfer, {})), 0, anew.levels()),
        expectTrue(read(transfer, pool, tree), reference::denseField(volumeOf(pool, transfer, {})), 0, tree.levels()));
  }
}

TEST(CellTree, HasTheFewestLevelsThatLeaveTwoNodes) {
  const auto levels = [](layout::uint bricks) { return cellTreeLevels({8, 8, 8 * bricks, 1, 1, bricks}); };
  EXPECT_EQ(levels(1), 1U);
  EXPECT_EQ(levels(8), 1U);  // two nodes of four bricks
  EXPECT_EQ(levels(9), 2U);
  EXPECT_EQ(levels(32), 2U);  // two of sixteen
  EXPECT_EQ(levels(33), 3U);
  EXPECT_EQ(levels(1000), 3U);
}

}  // namespace cell_tree_test
}  // namespace palpate
