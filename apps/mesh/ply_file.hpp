// SPDX-License-Identifier: Apache-2.0
// apps/mesh/ply_file.hpp: reads the mesh from a PLY file's bytes. Private to apps/mesh. Any thread; cost: one pass.
//
// Assimp 5.2 is not used for PLY: it does not check the header's counts, and it drops the first byte of binary values
// if that is a line feed (assimp issue 5341), as in one file of 256.
#pragma once

#include <string>
#include <string_view>

#include "base/triangle_mesh.hpp"

namespace palpate {

// Text or binary, of either byte order. Uses x, y and z of the element `vertex`, and the list `vertex_indices` (or
// `vertex_index`) of the elements `face` and `tristrips`. The polygons of `face` are cut into triangles; in `tristrips`
// -1 begins a new strip. All other elements and properties are skipped.
//
// Throws Error(kBadInput), which names `file`: a faulty header; values that are more or fewer than the header
// announces; a face of fewer than three corners; a corner that is no vertex; a vertex that is not finite. Binary values
// must end with the last byte. In text each element is a line of its own, and the last line must end too, since its
// last number may be cut otherwise. So a missing end of a file is always noticed. A digit lost within a text is not.
[[nodiscard]] TriangleMesh readPly(std::string_view bytes, const std::string& file);

}  // namespace palpate
