// SPDX-License-Identifier: Apache-2.0
// apps/mesh/stl_file.hpp: the mesh in an STL file's bytes, text or binary. Private to apps/mesh. Any thread; cost: one
// pass.
//
// Every triangle has three vertices of its own, in the file's order; the file's normals are not used. A file is binary
// where its count of triangles gives its length (84 bytes and 50 for each), whatever its first 80 bytes say.
#pragma once

#include <string>
#include <string_view>

#include "base/triangle_mesh.hpp"

namespace palpate {

// Throws Error(kBadInput), which names `file`: a binary file of another length than its count gives; text that does not
// follow the grammar, from `solid` to `endsolid`, as often as the file has solids; a vertex that is not finite. Of
// several solids, whole ones may be missing unnoticed.
[[nodiscard]] TriangleMesh readStl(std::string_view bytes, const std::string& file);

}  // namespace palpate
