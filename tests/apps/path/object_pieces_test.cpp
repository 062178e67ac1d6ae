// SPDX-License-Identifier: Apache-2.0
// Random volumes against a flood fill; what touches at an edge only is two pieces.
#include "apps/path/object_pieces.hpp"

#include <algorithm>
#include <array>
#include <map>
#include <random>

#include <gtest/gtest.h>

#include "grid_field.hpp"

namespace palpate {
namespace object_pieces_test {

// A number for each sample: that of the piece in order of discovery, -1 for background.
std::vector<int> flooded(const GridField& field) {
  const Vec3i size = field.size();
  std::vector<int> label(static_cast<std::size_t>(size.prod()), -1);
  const auto at = [&](const Vec3i& i) {
    return i.x() + size.x() * (i.y() + size.y() * static_cast<std::size_t>(i.z()));
  };
  int pieces = 0;
  for (int n = 0; n < size.prod(); ++n) {
    const Vec3i seed(n % size.x(), n / size.x() % size.y(), n / size.x() / size.y());
    if (label[at(seed)] >= 0 || !(field.value(seed) > 0)) continue;
    std::vector<Vec3i> open = {seed};
    label[at(seed)] = pieces;
    while (!open.empty()) {
      const Vec3i now = open.back();
      open.pop_back();
      for (int axis = 0; axis < 6; ++axis) {
        const Vec3i next = now + (axis % 2 == 0 ? 1 : -1) * Vec3i::Unit(axis / 2);
        if ((next.array() < 0).any() || (next.array() >= size.array()).any()) continue;
        if (label[at(next)] >= 0 || !(field.value(next) > 0)) continue;
        label[at(next)] = pieces;
        open.push_back(next);
      }
    }
    ++pieces;
  }
  return label;
}

TEST(ObjectPieces, AreThoseOfAFloodFill) {
  std::mt19937 random(7);
  for (int trial = 0; trial < 60; ++trial) {
    const Vec3i size(1 + static_cast<int>(random() % 21), 1 + static_cast<int>(random() % 19),
                     1 + static_cast<int>(random() % 18));
    // From specks to one porous body; around 0.31 of all samples pieces of every size are found side by side.
    const double share = 0.05 + 0.9 * static_cast<double>(trial) / 60;
    GridField field(size, Vec3::Constant(1e-3));
    // What is at the isovalue, 0, is background. Every other volume is made of whole blocks.
    const auto draw = [&] {
      return std::bernoulli_distribution(share)(random) ? 1.0F : random() % 2 == 0 ? 0.0F : -1.0F;
    };
    std::array<float, 27> of_block{};
    std::generate(of_block.begin(), of_block.end(), draw);
    for (int n = 0; n < size.prod(); ++n) {
      const Vec3i i(n % size.x(), n / size.x() % size.y(), n / size.x() / size.y());
      const Vec3i block = i / kFieldBlock;
      const std::size_t its = block.x() + 3 * (block.y() + 3 * static_cast<std::size_t>(block.z()));
      field.set(i, trial % 2 == 1 ? of_block[its] : draw());
    }
    const std::vector<int> label = flooded(field);
    const ObjectPieces pieces(field);
    std::map<int, std::size_t> piece_of;
    std::map<int, ObjectPiece> exact;
    for (int n = 0; n < size.prod(); ++n) {
      const Vec3i i(n % size.x(), n / size.x() % size.y(), n / size.x() / size.y());
      const int its = label[static_cast<std::size_t>(n)];
      const auto piece = pieces.pieceOf(i);
      ASSERT_EQ(piece.has_value(), its >= 0);
      if (its < 0) continue;
      ASSERT_EQ(piece_of.try_emplace(its, *piece).first->second, *piece) << "one piece, two numbers";
      ObjectPiece& e = exact.try_emplace(its, ObjectPiece{0, i, i}).first->second;
      ++e.voxels;
      e.first = e.first.cwiseMin(i);
      e.last = e.last.cwiseMax(i);
    }
    ASSERT_EQ(pieces.all().size(), exact.size());
    std::vector<int> order;  // the largest first, and of equal ones that which was discovered first
    for (const auto& [its, e] : exact) order.push_back(its);
    std::stable_sort(order.begin(), order.end(), [&](int a, int b) { return exact[a].voxels > exact[b].voxels; });
    for (std::size_t n = 0; n < order.size(); ++n) {
      const ObjectPiece &piece = pieces.all()[n], &e = exact[order[n]];
      ASSERT_EQ(piece_of[order[n]], n);
      ASSERT_EQ(piece.voxels, e.voxels);
      ASSERT_EQ(piece.first, e.first);
      ASSERT_EQ(piece.last, e.last);
    }
  }
}

TEST(ObjectPieces, TellWhatAPointOfTheSurfaceBelongsTo) {
  GridField field(Vec3i(20, 9, 9), Vec3(1e-3, 2e-3, 1e-3));
  field.fill({2, 2, 2}, {5, 6, 6}, 1);
  field.fill({8, 2, 2}, {17, 6, 6}, 1);
  const ObjectPieces pieces(field);
  ASSERT_EQ(pieces.all().size(), 2U);
  EXPECT_EQ(pieces.all()[0].voxels, 250);
  const auto pieceAt = [&](double i) { return pieces.pieceAt(field.lattice().toWorld({i, 4, 4})); };
  EXPECT_EQ(pieceAt(1.5), 1U);
  EXPECT_EQ(pieceAt(5.5), 1U);
  EXPECT_EQ(pieceAt(7.5), 0U);
  EXPECT_EQ(pieceAt(17.5), 0U);
  EXPECT_FALSE(pieceAt(6.5).has_value());
  EXPECT_FALSE(pieceAt(-5).has_value());
  // A surface that goes through a sample belongs to the cells on both sides of it, along every axis.
  EXPECT_EQ(pieceAt(6), 1U);
  EXPECT_EQ(pieceAt(7), 0U);
  for (const Vec3& p_L : {Vec3(4, 1, 4), Vec3(4, 7, 4), Vec3(4, 4, 1), Vec3(4, 4, 7)}) {
    EXPECT_EQ(pieces.pieceAt(field.lattice().toWorld(p_L)), 1U) << p_L.transpose();
  }
  EXPECT_FALSE(pieces.pieceAt(field.lattice().toWorld({4, 7.5, 4})).has_value());
  EXPECT_FALSE(pieces.pieceAt(field.lattice().toWorld({4, 4, 7.5})).has_value());
}

TEST(ObjectPieces, OfTwoInACellTheNearerOneIsMeant) {
  GridField field(Vec3i(4, 4, 3), Vec3::Constant(1e-3));
  field.fill({0, 1, 1}, {1, 1, 1}, 1);
  field.fill({2, 2, 1}, {2, 2, 1}, 1);
  const ObjectPieces pieces(field);
  EXPECT_EQ(pieces.pieceAt(field.lattice().toWorld({1.2, 1.4, 1})), 0U);
  EXPECT_EQ(pieces.pieceAt(field.lattice().toWorld({1.8, 1.6, 1})), 1U);
}

TEST(ObjectPieces, OutsideTheVolumeIsNone) {
  GridField field(Vec3i(3, 4, 5), Vec3::Constant(1e-3));
  field.fill({0, 0, 0}, {2, 3, 4}, 1);
  const ObjectPieces pieces(field);
  for (int axis = 0; axis < 3; ++axis) {
    Vec3i voxel(1, 1, 1);
    for (const int i : {-1, 0, field.size()[axis] - 1, field.size()[axis]}) {
      voxel[axis] = i;
      EXPECT_EQ(pieces.pieceOf(voxel).has_value(), i >= 0 && i < field.size()[axis]) << axis << ' ' << i;
    }
  }
}

TEST(ObjectPieces, EntriesAreBackgroundBesideThePiece) {
  GridField field(Vec3i(9, 9, 9), Vec3::Constant(1e-3));
  field.fill({0, 0, 0}, {4, 8, 8}, 1);  // to the border on five sides
  const ObjectPieces pieces(field);
  EXPECT_EQ(pieces.entries(0, 1000).size(), 81U);
  EXPECT_EQ(pieces.entries(0, 7).size(), 7U);
  for (const ObjectPieces::Entry& entry : pieces.entries(0, 7)) {
    EXPECT_EQ(entry.outside.x(), 5);
    EXPECT_EQ(entry.sense, -1);
  }
  field.fill({0, 0, 0}, {8, 8, 8}, 1);
  EXPECT_TRUE(ObjectPieces(field).entries(0, 7).empty());
}

// Two rows beside each other, one above, and a speck behind the first.
TEST(ObjectPieces, EntriesAreOnBothSidesOfEachRow) {
  GridField field(Vec3i(12, 4, 4), Vec3::Constant(1e-3));
  field.fill({3, 1, 1}, {6, 1, 1}, 1);
  field.fill({3, 2, 1}, {5, 2, 1}, 1);
  field.fill({4, 1, 2}, {8, 1, 2}, 1);
  field.fill({10, 1, 1}, {10, 1, 1}, 1);
  const ObjectPieces pieces(field);
  using Entry = std::array<int, 4>;
  const auto entries = [&](std::size_t piece, std::size_t count) {
    std::vector<Entry> all;
    for (const ObjectPieces::Entry& e : pieces.entries(piece, count))
      all.push_back({e.outside.x(), e.outside.y(), e.outside.z(), e.sense});
    return all;
  };
  const std::vector<Entry> of_first = {{2, 1, 1, 1},  {7, 1, 1, -1}, {2, 2, 1, 1},
                                       {6, 2, 1, -1}, {3, 1, 2, 1},  {9, 1, 2, -1}};
  EXPECT_EQ(entries(0, 6), of_first);
  EXPECT_EQ(entries(1, 6), (std::vector<Entry>{{9, 1, 1, 1}, {11, 1, 1, -1}}));
  // Four of six, evenly: numbers 0, 1.5, 3 and 4.5.
  EXPECT_EQ(entries(0, 4), (std::vector<Entry>{of_first[0], of_first[1], of_first[3], of_first[4]}));
}

TEST(ObjectPieces, OfAnEmptyVolumeAreNone) {
  EXPECT_TRUE(ObjectPieces(GridField(Vec3i(3, 3, 3), Vec3::Constant(1e-3))).all().empty());
}

}  // namespace object_pieces_test
}  // namespace palpate
