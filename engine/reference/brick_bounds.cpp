// SPDX-License-Identifier: Apache-2.0
#include "engine/reference/brick_bounds.hpp"

#include <algorithm>

namespace palpate::reference {
namespace {

template <typename Visit>
void forEachCorner(int i, int j, int k, Visit visit) {
  for (int corner = 0; corner < 8; ++corner) visit(i + (corner & 1), j + (corner >> 1 & 1), k + (corner >> 2));
}

bool cellIsCrossed(const DenseField& field, int i, int j, int k, float isovalue) {
  bool above = false;
  bool below = false;
  forEachCorner(i, j, k, [&](int x, int y, int z) { (field.at(x, y, z) > isovalue ? above : below) = true; });
  return above && below;
}

}  // namespace

Bounds brickBounds(const DenseField& field, const Vec3i& brick) {
  const Vec3i first = brick * kBrickSize;
  const Vec3i last = (first.array() + kBrickSize).min(field.size.array() - 1);
  Bounds bounds{field.at(first.x(), first.y(), first.z()), field.at(first.x(), first.y(), first.z())};
  for (int k = first.z(); k <= last.z(); ++k) {
    for (int j = first.y(); j <= last.y(); ++j) {
      for (int i = first.x(); i <= last.x(); ++i) {
        bounds.lowest = std::min(bounds.lowest, field.at(i, j, k));
        bounds.highest = std::max(bounds.highest, field.at(i, j, k));
      }
    }
  }
  return bounds;
}

std::vector<std::size_t> bricksOfCrossedCells(const DenseField& field, float isovalue) {
  const Vec3i bricks = (field.size.array() + kBrickSize - 1) / kBrickSize;
  std::vector<bool> needed(static_cast<std::size_t>(bricks.x()) * bricks.y() * bricks.z());
  const auto mark = [&](int x, int y, int z) {
    needed[(static_cast<std::size_t>(z / kBrickSize) * bricks.y() + y / kBrickSize) * bricks.x() + x / kBrickSize] =
        true;
  };
  for (int k = 0; k + 1 < field.size.z(); ++k) {
    for (int j = 0; j + 1 < field.size.y(); ++j) {
      for (int i = 0; i + 1 < field.size.x(); ++i) {
        if (cellIsCrossed(field, i, j, k, isovalue)) forEachCorner(i, j, k, mark);
      }
    }
  }
  std::vector<std::size_t> list;
  for (std::size_t b = 0; b < needed.size(); ++b) {
    if (needed[b]) list.push_back(b);
  }
  return list;
}

}  // namespace palpate::reference
