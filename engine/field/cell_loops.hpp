// SPDX-License-Identifier: Apache-2.0
// engine/field/cell_loops.hpp: how an isosurface passes through one cell of eight voxels, as closed loops on the cell's
// faces. Any thread.
//
// Numbering: corner c of a cell lies at (c & 1, c >> 1 & 1, c >> 2 & 1). Edges 4 a to 4 a + 3 run along axis a. Face
// 2 a + s is perpendicular to axis a, on side s.
//
// A corner is inside if its density is above the isovalue. The surface crosses an edge that has one end inside and one
// outside. On a face, the surface is one line between two crossed edges, or two lines between four.
//
// A face with four crossed edges is ambiguous: two corners on a diagonal are inside, the other two are outside. Its two
// lines either go around each inside corner, or they join the inside corners and go around each outside corner.
//
// The lines on all faces of a cell form loops. Each crossed edge belongs to exactly one loop.
#pragma once

#include <array>
#include <cstdint>

#include "base/vec.hpp"

namespace palpate {

inline constexpr int kCellEdges = 12;

[[nodiscard]] Vec3i cornerPlace(int corner) noexcept;  // of a cell whose first corner is at the origin [voxel]

// The corners at an edge's ends. The first is the lower one along the edge's axis.
struct EdgeEnds {
  int first = 0, last = 0;
};
[[nodiscard]] EdgeEnds edgeEnds(int edge) noexcept;
[[nodiscard]] int edgeFrom(int corner, int axis) noexcept;  // the edge along `axis` whose first corner is `corner`
[[nodiscard]] int edgeBetween(int corner, int neighbour) noexcept;
[[nodiscard]] bool shareFace(int edge, int other) noexcept;

// The corners of a face, in order around it: counter-clockwise, seen against the face's axis.
[[nodiscard]] std::array<int, 4> faceCorners(int face) noexcept;

// Whether a face is ambiguous. `inside`: a bit for each corner of the cell.
[[nodiscard]] bool isAmbiguous(std::uint8_t inside, int face) noexcept;

// A line on a face, from one crossed edge to another. Seen from outside of the cell, the object is on its right.
struct FaceLine {
  int from = 0, to = 0;
};
// Of two lines, the first one ends or begins at the edge between the face's corners 0 and 1. So the two cells of a face
// number its lines in the same way. Each of the two sees a line in the opposite direction.
struct FaceLines {
  int count = 0;
  std::array<FaceLine, 2> lines;
};
// `joined`: a bit for each ambiguous face on which the inside corners are joined.
[[nodiscard]] FaceLines faceLines(std::uint8_t inside, std::uint8_t joined, int face) noexcept;

// A loop is a ring of steps; seen from outside of the object, they go around it counter-clockwise.
struct LoopStep {
  int edge = 0;            // that the loop crosses
  int face = 0, line = 0;  // on which it goes on to the next step's edge
};
struct CellLoops {
  int count = 0;
  std::array<int, 5> first{};  // loop n has the steps first[n] to first[n + 1] - 1
  std::array<LoopStep, kCellEdges> steps;
};
[[nodiscard]] CellLoops loopsOf(std::uint8_t inside, std::uint8_t joined) noexcept;

}  // namespace palpate
