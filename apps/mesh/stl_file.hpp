// SPDX-License-Identifier: Apache-2.0
// apps/mesh/stl_file.hpp: reads the mesh from an STL file's bytes, text or binary. Private to apps/mesh. Any thread;
// cost: one pass.
//
// Every triangle has three vertices of its own, in the file's order. The file's normals are ignored. A file is binary
// if its length fits its count of triangles (84 bytes, and 50 for each triangle), whatever its first 80 bytes are.
#pragma once

#include <string>
#include <string_view>

#include "base/triangle_mesh.hpp"

namespace palpate {

// Throws Error(kBadInput), which names `file`: a binary file whose length does not fit its count; text that does not
// follow the grammar from `solid` to `endsolid`, for one or more solids; a vertex that is not finite. If whole solids
// are missing from a text, this is not noticed.
[[nodiscard]] TriangleMesh readStl(std::string_view bytes, const std::string& file);

}  // namespace palpate
