// SPDX-License-Identifier: Apache-2.0
#include "engine/field/cell_loops.hpp"

namespace palpate {
namespace {

bool isIn(std::uint8_t set, int bit) noexcept {
  return (set >> bit & 1) != 0;
}

int edgeBetween(int a, int b) noexcept {
  const int differ = a ^ b;
  return edgeFrom(a & b, differ == 1 ? 0 : differ == 2 ? 1 : 2);
}

}  // namespace

EdgeEnds edgeEnds(int edge) noexcept {
  const int axis = edge / 4;
  const int other = edge % 4;
  const int first = axis == 0 ? other << 1 : axis == 1 ? (other & 1) | (other & 2) << 1 : other;
  return {first, first | 1 << axis};
}

int edgeFrom(int corner, int axis) noexcept {
  const int x = corner & 1, y = corner >> 1 & 1, z = corner >> 2 & 1;
  return 4 * axis + (axis == 0 ? y + 2 * z : axis == 1 ? x + 2 * z : x + 2 * y);
}

std::array<int, 4> faceCorners(int face) noexcept {
  const int axis = face / 2;
  const int base = face % 2 << axis;
  const int u = 1 << (axis + 1) % 3;
  const int v = 1 << (axis + 2) % 3;
  return {base, base | u, base | u | v, base | v};
}

bool isAmbiguous(std::uint8_t inside, int face) noexcept {
  const auto c = faceCorners(face);
  return isIn(inside, c[0]) == isIn(inside, c[2]) && isIn(inside, c[1]) == isIn(inside, c[3]) &&
         isIn(inside, c[0]) != isIn(inside, c[1]);
}

std::array<int, 4> facePairs(std::uint8_t inside, std::uint8_t joined, int face) noexcept {
  const auto c = faceCorners(face);
  // The lines go around the corners 0 and 2, or around 1 and 3.
  const bool around_first = isIn(inside, c[0]) != isIn(joined, face);
  const int e01 = edgeBetween(c[0], c[1]), e12 = edgeBetween(c[1], c[2]);
  const int e23 = edgeBetween(c[2], c[3]), e30 = edgeBetween(c[3], c[0]);
  return around_first ? std::array{e30, e01, e12, e23} : std::array{e01, e12, e23, e30};
}

CellLoops loopsOf(std::uint8_t inside, std::uint8_t joined) noexcept {
  // For each crossed edge, the two edges to which lines lead from it, one on each of its faces.
  std::array<std::array<int, 2>, kCellEdges> next{};
  std::array<int, kCellEdges> known{};
  const auto link = [&](int a, int b) {
    next[static_cast<std::size_t>(a)][static_cast<std::size_t>(known[static_cast<std::size_t>(a)]++)] = b;
    next[static_cast<std::size_t>(b)][static_cast<std::size_t>(known[static_cast<std::size_t>(b)]++)] = a;
  };
  for (int face = 0; face < 6; ++face) {
    if (isAmbiguous(inside, face)) {
      const auto pairs = facePairs(inside, joined, face);
      link(pairs[0], pairs[1]);
      link(pairs[2], pairs[3]);
      continue;
    }
    const auto c = faceCorners(face);
    int crossed[2] = {};
    int count = 0;
    for (std::size_t n = 0; n < 4; ++n) {
      const int a = c[n];
      const int b = c[(n + 1) % 4];
      if (isIn(inside, a) != isIn(inside, b)) crossed[count++] = edgeBetween(a, b);
    }
    if (count == 2) link(crossed[0], crossed[1]);
  }
  CellLoops loops;
  loops.of_edge.fill(kNoLoop);
  for (int start = 0; start < kCellEdges; ++start) {
    if (known[static_cast<std::size_t>(start)] == 0 || loops.of_edge[static_cast<std::size_t>(start)] != kNoLoop) {
      continue;
    }
    int edge = start;
    while (loops.of_edge[static_cast<std::size_t>(edge)] == kNoLoop) {
      loops.of_edge[static_cast<std::size_t>(edge)] = static_cast<std::uint8_t>(loops.count);
      const auto& neighbours = next[static_cast<std::size_t>(edge)];
      edge = loops.of_edge[static_cast<std::size_t>(neighbours[0])] == kNoLoop ? neighbours[0] : neighbours[1];
    }
    ++loops.count;
  }
  return loops;
}

}  // namespace palpate
