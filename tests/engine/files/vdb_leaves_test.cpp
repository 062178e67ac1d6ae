// SPDX-License-Identifier: Apache-2.0
// Leaves of a .vdb file that become bricks of the volume without a copy. The truth is the way that copies: grids of
// doubles go through it voxel by voxel, and a float made double and back keeps its bits.
#include <random>

#include <openvdb/openvdb.h>

#include "engine/files/volume_file.hpp"
#include "engine/vdb/vdb_grid.hpp"
#include "tests/engine/files/files.hpp"

namespace palpate {
namespace vdb_leaves_test {

using openvdb::Coord;
using Leaf = ScalarTree::LeafNodeType;

void expectSameBits(const float* a, const float* b, std::size_t count) {
  EXPECT_EQ(std::memcmp(a, b, count * sizeof *a), 0);
}

// Leaves, their masks, tiles and background: all that the grid consists of.
void expectSameTree(const ScalarTree& tree, const ScalarTree& want) {
  ASSERT_TRUE(tree.hasSameTopology(want));
  auto leaf = tree.cbeginLeaf();
  for (auto want_leaf = want.cbeginLeaf(); want_leaf; ++want_leaf, ++leaf) {
    ASSERT_EQ(leaf->origin(), want_leaf->origin());
    EXPECT_TRUE(leaf->getValueMask() == want_leaf->getValueMask());
    expectSameBits(leaf->buffer().data(), want_leaf->buffer().data(), kBrickVoxels);
  }
  auto tile = tree.cbeginValueAll();
  tile.setMaxDepth(tile.getLeafDepth() - 1);
  auto want_tile = want.cbeginValueAll();
  want_tile.setMaxDepth(want_tile.getLeafDepth() - 1);
  for (; want_tile; ++want_tile, ++tile) {
    ASSERT_EQ(tile.getCoord(), want_tile.getCoord());
    expectSameBits(&tile.getValue(), &want_tile.getValue(), 1);
  }
  expectSameBits(&tree.background(), &want.background(), 1);
}

class VdbLeaves : public testing::Test {
 protected:
  void SetUp() override { openvdb::initialize(); }

  static openvdb::FloatGrid::Ptr makeGrid(float background = 0) {
    auto grid = openvdb::FloatGrid::create(background);
    grid->setTransform(openvdb::math::Transform::createLinearTransform(0.5));
    return grid;
  }

  // Random values, with both zeroes and a denormal now and then, which are neither the lowest nor the highest.
  void fill(openvdb::FloatGrid& grid, const Coord& first, const Coord& last, bool active = true) {
    auto values = grid.getAccessor();
    for (const Coord& voxel : openvdb::CoordBBox(first, last)) {
      const auto n = static_cast<std::uint32_t>(random_());
      const float special[] = {0.0F, -0.0F, 1e-40F};
      const float value = n % 16 < 3 ? special[n % 16] : static_cast<float>(n >> 8U) - 8e6F;
      active ? values.setValueOn(voxel, value) : values.setValueOff(voxel, value);
    }
  }

  // As Palpate's files say it.
  static void nameDomain(openvdb::GridBase& grid, int nx, int ny, int nz) {
    grid.insertMeta(kVdbDomainKey, openvdb::Vec3IMetadata(openvdb::Vec3i(nx, ny, nz)));
  }

  [[nodiscard]] std::string write(const openvdb::GridBase::Ptr& grid, const std::string& name) const {
    openvdb::io::File(folder_.file(name)).write(openvdb::GridPtrVec{grid});
    return folder_.file(name);
  }

  [[nodiscard]] std::string writeAsDoubles(const openvdb::FloatGrid& grid) const {
    const auto doubles = openvdb::DoubleGrid::create(std::make_shared<openvdb::DoubleTree>(grid.tree()));
    for (auto entry = grid.beginMeta(); entry != grid.endMeta(); ++entry)
      doubles->insertMeta(entry->first, *entry->second);
    doubles->setTransform(grid.transform().copy());
    return write(doubles, "doubles.vdb");
  }

  // Returns the volume, for what is to be said of one.
  Volume expectSameAsCopied(const openvdb::FloatGrid::Ptr& grid) const {
    Volume volume = loadVolume(write(grid, "floats.vdb"));
    const Volume copied = loadVolume(writeAsDoubles(*grid));
    EXPECT_EQ(volume.size(), copied.size());
    expectLattice(volume.lattice(), copied.lattice(), 0);
    EXPECT_EQ(volume.minimum(), copied.minimum());
    EXPECT_EQ(volume.maximum(), copied.maximum());
    expectSameTree(vdbGridOf(volume)->tree(), vdbGridOf(copied)->tree());
    EXPECT_EQ(vdbGridOf(volume)->activeVoxelCount(), volume.size().cast<std::uint64_t>().prod());
    return volume;
  }

  TempFolder folder_;
  std::mt19937 random_{7};
};

// Whole bricks, bricks that the border cuts, and what Palpate itself wrote of both.
TEST_F(VdbLeaves, OfADomainThatIsNamed) {
  for (const Coord& size : {Coord(24, 16, 32), Coord(21, 17, 30)}) {
    const auto grid = makeGrid();
    fill(*grid, Coord(0), size.offsetBy(-1));
    nameDomain(*grid, size.x(), size.y(), size.z());
    const Volume volume = expectSameAsCopied(grid);
    EXPECT_EQ(volume.size(), Vec3i(size.x(), size.y(), size.z()));
    saveVolume(volume, folder_.file("own.vdb"));
    expectSameTree(vdbGridOf(loadVolume(folder_.file("own.vdb")))->tree(), vdbGridOf(volume)->tree());
  }
}

// Values beyond the domain, inactive as they must be there, and in the same leaves as values inside.
TEST_F(VdbLeaves, ThatReachOutOfTheDomain) {
  const auto grid = makeGrid();
  fill(*grid, Coord(-8), Coord(31), false);
  fill(*grid, Coord(0), Coord(20, 15, 9));
  nameDomain(*grid, 21, 16, 10);
  const Volume volume = expectSameAsCopied(grid);
  EXPECT_EQ(volume.storedBricks(), 3U * 2U * 2U);
}

// The domain is the active box and two voxels around it: at a leaf's corner, and elsewhere.
TEST_F(VdbLeaves, OfADomainThatIsNotNamed) {
  for (const Coord& first : {Coord(2, 10, -6), Coord(2, 10, -5), Coord(1, 0, 0), Coord(-13, 27, 4)}) {
    const auto grid = makeGrid(3);
    fill(*grid, first.offsetBy(-4), first.offsetBy(40), false);
    fill(*grid, first, first.offsetBy(25));
    EXPECT_EQ(expectSameAsCopied(grid).size(), Vec3i::Constant(30)) << first;
  }
}

TEST_F(VdbLeaves, WithVoxelsThatAreNotActive) {
  const auto grid = makeGrid();
  fill(*grid, Coord(0), Coord(23));
  for (auto voxel = grid->tree().beginValueOn(); voxel; ++voxel) voxel.setActiveState(random_() % 2 == 0);
  nameDomain(*grid, 24, 24, 24);
  EXPECT_EQ(expectSameAsCopied(grid).storedBricks(), 27U);
}

// One leaf holds one value, partly active; another, by all its bits but one, does not.
TEST_F(VdbLeaves, OfOneValueBecomeTiles) {
  const auto grid = makeGrid();
  fill(*grid, Coord(0), Coord(15));
  for (const Coord& corner : {Coord(8, 0, 0), Coord(0, 8, 8)}) {
    for (const Coord& voxel : openvdb::CoordBBox(corner, corner.offsetBy(kBrickSize - 1)))
      grid->tree().setValueOn(voxel, 0.0F);
  }
  grid->tree().setValueOff(Coord(9, 1, 1), 0.0F);
  grid->tree().setValueOn(Coord(7, 15, 15), -0.0F);
  nameDomain(*grid, 16, 16, 16);
  const Volume volume = expectSameAsCopied(grid);
  EXPECT_EQ(volume.storedBricks(), 7U);
  EXPECT_EQ(vdbGridOf(volume)->tree().probeLeaf(Coord(8, 0, 0)), nullptr);
}

// The first in the order of a file of slices: by k, then j, then i; bricks are visited in another order.
TEST_F(VdbLeaves, WithNoNumbersAreRefused) {
  const auto grid = makeGrid();
  fill(*grid, Coord(0), Coord(23));
  nameDomain(*grid, 24, 24, 24);
  const float nan = std::numeric_limits<float>::quiet_NaN();
  grid->tree().setValueOn(Coord(2, 3, 7), nan);
  grid->tree().setValueOn(Coord(9, 1, 7), -std::numeric_limits<float>::infinity());
  grid->tree().setValueOn(Coord(20, 20, 20), nan);
  grid->tree().setValueOff(Coord(21, 20, 20), nan);
  const std::string reason = "4 of its 13824 voxels are NaN or infinite, the first at index (9, 1, 7)";
  expectLoadRefusal(write(grid, "floats.vdb"), reason);
  expectLoadRefusal(writeAsDoubles(*grid), reason);
}

// Minus the distance: no leaf can stay as it is. In a level set of metres the factor is -1 exactly.
TEST_F(VdbLeaves, OfALevelSetAreTurned) {
  const auto grid = makeGrid(0.1F);
  fill(*grid, Coord(0), Coord(23));
  grid->setGridClass(openvdb::GRID_LEVEL_SET);
  nameDomain(*grid, 24, 24, 24);
  const float value = grid->tree().getValue(Coord(3, 4, 5));
  EXPECT_EQ(expectSameAsCopied(grid).value({3, 4, 5}), -value);
}

// What the file holds of the other grid does not matter, and the named one is the one that is taken.
TEST_F(VdbLeaves, OfTheGridThatIsNamed) {
  const auto first = makeGrid(), second = makeGrid();
  first->setName("first");
  second->setName("second");
  for (const auto& grid : {first, second}) {
    fill(*grid, Coord(0), Coord(15));
    nameDomain(*grid, 16, 16, 16);
  }
  openvdb::io::File(folder_.file("two.vdb")).write(openvdb::GridPtrVec{first, second});
  const Volume volume = loadVolume(folder_.file("two.vdb") + "#second");
  expectSameTree(vdbGridOf(volume)->tree(), vdbGridOf(expectSameAsCopied(second))->tree());
}

// The memory itself changes hands; the source is asked for the brick that has no leaf, and for the one whose leaf holds
// an infinity, which stays as it was.
TEST_F(VdbLeaves, AreNotCopied) {
  openvdb::FloatTree tree;
  for (const int i : {0, 8, 24}) tree.touchLeaf(Coord(i, 0, 0))->setValueOn(0, 5);
  tree.setValueOn(Coord(25, 0, 0), std::numeric_limits<float>::infinity());
  const float* memory = tree.probeLeaf(Coord(8, 0, 0))->buffer().data();
  std::vector<int> asked;
  const BrickSource source = [&](const Vec3i& brick, float* values) {
    asked.push_back(brick.x());
    values[0] = 7;
    return true;
  };
  const LeafSource leaf_of = [&](const Vec3i& brick) { return tree.probeLeaf(Coord(brick.x() * kBrickSize, 0, 0)); };
  const Volume volume(buildGridByLayers(
      {32, 8, 8}, Lattice{}, {}, [&](int) { return source; }, leaf_of));
  EXPECT_EQ(asked, (std::vector{2, 3}));
  EXPECT_EQ(vdbGridOf(volume)->tree().probeConstLeaf(Coord(8, 0, 0))->buffer().data(), memory);
  EXPECT_TRUE(tree.probeLeaf(Coord(8, 0, 0))->buffer().empty());
  EXPECT_EQ(tree.getValue(Coord(24, 0, 0)), 5);
  EXPECT_EQ(volume.value({8, 0, 0}), 5);
  EXPECT_EQ(volume.value({16, 0, 0}), 7);
}

}  // namespace vdb_leaves_test
}  // namespace palpate
