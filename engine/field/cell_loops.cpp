// SPDX-License-Identifier: Apache-2.0
#include "engine/field/cell_loops.hpp"

#include <utility>

namespace palpate {
namespace {

bool isIn(std::uint8_t set, int bit) noexcept {
  return (set >> bit & 1) != 0;
}

}  // namespace

Vec3i cornerPlace(int corner) noexcept {
  return {corner & 1, corner >> 1 & 1, corner >> 2 & 1};
}

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

int edgeBetween(int corner, int neighbour) noexcept {
  const int differ = corner ^ neighbour;
  return edgeFrom(corner & neighbour, differ == 1 ? 0 : differ == 2 ? 1 : 2);
}

bool shareFace(int edge, int other) noexcept {
  const EdgeEnds a = edgeEnds(edge), b = edgeEnds(other);
  return (a.first & a.last & b.first & b.last) != 0 || (a.first | a.last | b.first | b.last) != 7;
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

FaceLines faceLines(std::uint8_t inside, std::uint8_t joined, int face) noexcept {
  const auto c = faceCorners(face);
  const std::array<int, 4> edges = {edgeBetween(c[0], c[1]), edgeBetween(c[1], c[2]), edgeBetween(c[2], c[3]),
                                    edgeBetween(c[3], c[0])};
  // Going around the face's corners, a line begins where the way leaves the object, and ends where it enters.
  std::array<int, 2> leaving{}, entering{};
  std::size_t leaving_count = 0, entering_count = 0;
  for (std::size_t n = 0; n < 4; ++n) {
    const bool here = isIn(inside, c[n]), there = isIn(inside, c[(n + 1) % 4]);
    if (here && !there) leaving[leaving_count++] = edges[n];
    if (!here && there) entering[entering_count++] = edges[n];
  }
  FaceLines lines;
  lines.count = static_cast<int>(leaving_count);
  if (lines.count == 1) lines.lines[0] = {leaving[0], entering[0]};
  if (lines.count == 2) {
    // Edge 0 leaves if corner 0 is inside. Around an inside corner n, the line goes from edge n to the one before.
    const bool edge_0_leaves = isIn(inside, c[0]);
    const bool around_0 = edge_0_leaves != isIn(joined, face);
    const int beside = around_0 ? edges[3] : edges[1];
    const int third = edges[2], fourth = around_0 ? edges[1] : edges[3];
    lines.lines[0] = edge_0_leaves ? FaceLine{edges[0], beside} : FaceLine{beside, edges[0]};
    lines.lines[1] = edge_0_leaves ? FaceLine{third, fourth} : FaceLine{fourth, third};
  }
  // So on a face of the lower side, which is seen from outside against the corners' order.
  if (face % 2 == 1) {
    for (FaceLine& line : lines.lines) std::swap(line.from, line.to);
  }
  return lines;
}

CellLoops loopsOf(std::uint8_t inside, std::uint8_t joined) noexcept {
  constexpr int kNone = -1;
  std::array<int, kCellEdges> next;
  next.fill(kNone);
  std::array<LoopStep, kCellEdges> step_from{};
  for (int face = 0; face < 6; ++face) {
    const FaceLines found = faceLines(inside, joined, face);
    for (int n = 0; n < found.count; ++n) {
      const FaceLine& line = found.lines[static_cast<std::size_t>(n)];
      next[static_cast<std::size_t>(line.from)] = line.to;
      step_from[static_cast<std::size_t>(line.from)] = {line.from, face, n};
    }
  }
  CellLoops loops;
  int steps = 0;
  for (int start = 0; start < kCellEdges; ++start) {
    if (next[static_cast<std::size_t>(start)] == kNone) continue;
    int edge = start;
    while (next[static_cast<std::size_t>(edge)] != kNone) {
      loops.steps[static_cast<std::size_t>(steps++)] = step_from[static_cast<std::size_t>(edge)];
      edge = std::exchange(next[static_cast<std::size_t>(edge)], kNone);
    }
    loops.first[static_cast<std::size_t>(++loops.count)] = steps;
  }
  return loops;
}

}  // namespace palpate
