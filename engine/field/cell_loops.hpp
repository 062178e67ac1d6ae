// SPDX-License-Identifier: Apache-2.0
// engine/field/cell_loops.hpp: how an isosurface goes through one cell of eight voxels: as loops around parts of it.
// Any thread.
//
// Corner c of a cell lies at (c & 1, c >> 1 & 1, c >> 2 & 1). Edges 4 a to 4 a + 3 run along axis a; face 2 a + s is
// the one across axis a on side s. The surface crosses an edge between a corner inside and one outside. On a face it
// goes from crossed edge to crossed edge: past one pair, or two pairs where two corners that face each other are inside
// and the other two are not. Then it either goes around each inside corner, or joins them, that is, goes around each
// outside corner. In the cell, these ways form loops: each crossed edge belongs to one.
#pragma once

#include <array>
#include <cstdint>

namespace palpate {

inline constexpr int kCellEdges = 12;
inline constexpr int kNoLoop = 15;

// The corners at an edge's ends, the first lower along the edge's axis.
struct EdgeEnds {
  int first = 0, last = 0;
};
[[nodiscard]] EdgeEnds edgeEnds(int edge) noexcept;
[[nodiscard]] int edgeFrom(int corner, int axis) noexcept;  // its first corner, and where it goes

// The corners of a face, around it.
[[nodiscard]] std::array<int, 4> faceCorners(int face) noexcept;

// Whether two corners that face each other are inside and the other two are not. `inside`: a bit for each corner.
[[nodiscard]] bool isAmbiguous(std::uint8_t inside, int face) noexcept;

struct CellLoops {
  int count = 0;
  std::array<std::uint8_t, kCellEdges> of_edge{};  // which loop it belongs to; kNoLoop: it is not crossed
};

// `joined`: a bit for each ambiguous face on which the inside corners are joined.
[[nodiscard]] CellLoops loopsOf(std::uint8_t inside, std::uint8_t joined) noexcept;

// The pairs of crossed edges on an ambiguous face: the first two belong together, and the last two.
[[nodiscard]] std::array<int, 4> facePairs(std::uint8_t inside, std::uint8_t joined, int face) noexcept;

}  // namespace palpate
