// SPDX-License-Identifier: Apache-2.0
// apps/mesh/mesh_file.hpp: reads a triangle mesh from an OBJ, STL or PLY file. Set-up only, any thread.
//
// Coordinates stay in the file's unit and frame. Convex polygons are cut into triangles, points and lines are left out,
// and all parts of a file become one mesh. Assimp reads OBJ, in a child process (base/child_process.hpp). STL and PLY
// say how much they hold, and their readers here hold them to it (stl_file.hpp, ply_file.hpp).
#pragma once

#include <string>

#include "base/triangle_mesh.hpp"

namespace palpate {

inline constexpr std::uintmax_t kLargestMeshFile = 1ULL << 30;  // [byte]

// Throws Error: kNotFound for a missing file; kIo for a file that cannot be read; kBadInput for a folder, another
// format, an empty, damaged or too large file, no triangles, vertices that are not finite, and triangles that name
// missing vertices; kOutOfMemory.
[[nodiscard]] TriangleMesh readMeshFile(const std::string& file);

}  // namespace palpate
