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

namespace palpate {

inline constexpr int kCellEdges = 12;
inline constexpr int kNoLoop = 15;

// The corners at an edge's ends. The first is the lower one along the edge's axis.
struct EdgeEnds {
  int first = 0, last = 0;
};
[[nodiscard]] EdgeEnds edgeEnds(int edge) noexcept;
[[nodiscard]] int edgeFrom(int corner, int axis) noexcept;  // the edge along `axis` whose first corner is `corner`

// The corners of a face, in order around it.
[[nodiscard]] std::array<int, 4> faceCorners(int face) noexcept;

// Whether a face is ambiguous. `inside`: a bit for each corner of the cell.
[[nodiscard]] bool isAmbiguous(std::uint8_t inside, int face) noexcept;

struct CellLoops {
  int count = 0;
  std::array<std::uint8_t, kCellEdges> of_edge{};  // the loop that each edge belongs to; kNoLoop: it is not crossed
};

// `joined`: a bit for each ambiguous face on which the inside corners are joined.
[[nodiscard]] CellLoops loopsOf(std::uint8_t inside, std::uint8_t joined) noexcept;

// The four crossed edges of an ambiguous face: one line runs between the first two, the other between the last two.
[[nodiscard]] std::array<int, 4> facePairs(std::uint8_t inside, std::uint8_t joined, int face) noexcept;

}  // namespace palpate
