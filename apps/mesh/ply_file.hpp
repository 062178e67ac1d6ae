// SPDX-License-Identifier: Apache-2.0
// apps/mesh/ply_file.hpp: the mesh in a PLY file's bytes. Private to apps/mesh. Any thread; cost: one pass.
//
// Its own reader, because Assimp 5.2 takes the header's counts lightly, and drops the first byte of binary values where
// that is a line feed (assimp issue 5341), as in one file of 256.
#pragma once

#include <string>
#include <string_view>

#include "base/triangle_mesh.hpp"

namespace palpate {

// Text or binary, of either byte order. Taken are x, y and z of the element `vertex`, and the list `vertex_indices` (or
// `vertex_index`) of `face`, whose polygons are cut into triangles, and of `tristrips`, where -1 begins a new strip.
// Everything else is read over, lists too.
//
// Throws Error(kBadInput), which names `file`, unless the values are exactly those that the header announces: binary
// values end with the last byte. In text every element is a line of its own with as many numbers as it has properties,
// and the last line ends, as a number may be cut otherwise. Also: a faulty header, a face of fewer than three corners,
// a corner that is no vertex, a vertex that is not finite. So no end of a file can be missing,
// and no byte of a binary one that holds triangles alone. A digit lost within a text is not seen.
[[nodiscard]] TriangleMesh readPly(std::string_view bytes, const std::string& file);

}  // namespace palpate
