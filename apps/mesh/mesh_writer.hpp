// SPDX-License-Identifier: Apache-2.0
// apps/mesh/mesh_writer.hpp: writes a triangle mesh as STL (binary), PLY (binary, little-endian) or OBJ; the suffix of
// the name decides.
//
// Coordinates are the mesh's [m] times `units_per_metre`, in the world frame (LPS), as 32-bit floats. In OBJ they have
// nine digits, which give a float exactly. Triangles keep their order and orientation. Any thread; memory: a few KiB.
#pragma once

#include <cstddef>
#include <string>

#include "base/byte_sink.hpp"
#include "base/triangle_mesh.hpp"

namespace palpate {

// Whether the suffix is .stl, .obj or .ply, in any case.
[[nodiscard]] bool isMeshFileName(const std::string& name);
inline constexpr const char* kMeshFileSuffixes = ".stl, .obj, .ply";

// How many of its triangles have no area once their corners are 32-bit floats, two in one place or all on a line: small
// ones far from the origin.
[[nodiscard]] std::size_t collapsedTriangles(const TriangleMesh& mesh, double units_per_metre);

// Refuses (Error kBadInput) another suffix, a mesh without triangles, and a mesh too large for the format (STL: 2^32 -
// 1 triangles; PLY: 2^31 - 1 vertices).
void writeMesh(const TriangleMesh& mesh, const std::string& name, double units_per_metre, const ByteSink& sink);

}  // namespace palpate
