// SPDX-License-Identifier: Apache-2.0
// apps/mesh/mesh_writer.hpp: a triangle mesh written as STL (binary), PLY (binary, little-endian) or OBJ, by its
// suffix.
//
// Coordinates are the mesh's times `units_per_metre`, in LPS as everywhere, as 32-bit floats (OBJ: nine digits, which
// hold one exactly). Triangles keep their order and direction. Any thread; memory: a few KiB.
#pragma once

#include <string>

#include "base/byte_sink.hpp"
#include "base/triangle_mesh.hpp"

namespace palpate {

// Whether the suffix is .stl, .obj or .ply, in any case.
[[nodiscard]] bool isMeshFileName(const std::string& name);
inline constexpr const char* kMeshFileSuffixes = ".stl, .obj, .ply";

// Refuses (Error kBadInput) another suffix, a mesh without triangles, and more triangles than the format can count
// (STL: 2^32 - 1; PLY: 2^31 - 1 vertices).
void writeMesh(const TriangleMesh& mesh, const std::string& name, double units_per_metre, const ByteSink& sink);

}  // namespace palpate
