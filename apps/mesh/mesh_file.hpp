// SPDX-License-Identifier: Apache-2.0
// apps/mesh/mesh_file.hpp: reads a triangle mesh from an OBJ, STL or PLY file, through Assimp. Set-up only, any thread.
//
// Coordinates are the file's own, polygons (convex ones) are cut into triangles, points and lines are left out, the
// parts of a file become one mesh. Assimp stays inside the .cpp, and reads in a child process (base/child_process.hpp).
#pragma once

#include <string>

#include "base/triangle_mesh.hpp"

namespace palpate {

inline constexpr std::uintmax_t kLargestMeshFile = 1ULL << 30;  // [byte]

// Throws Error: kNotFound for a file that is not there; kIo for one that cannot be read; kBadInput for a folder,
// another format, an empty, damaged or too large file, one without triangles, vertices that are not finite, and
// triangles that name vertices which do not exist; kOutOfMemory.
[[nodiscard]] TriangleMesh readMeshFile(const std::string& file);

}  // namespace palpate
