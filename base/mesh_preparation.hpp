// SPDX-License-Identifier: Apache-2.0
// base/mesh_preparation.hpp: makes a mesh fit to be touched or stamped, or says why it cannot be.
//
// - Vertices at one place become one, so that neighbours share edges (STL repeats every vertex).
// - Triangles without a plane (two corners at one place, or thinner than kThinnest_m) are dropped, with a note.
// - A mesh is closed when its triangles pass every edge as often in one direction as in the other. A closed mesh with
//   its normals inwards (negative volume) is turned, with a note.
// - A mesh that is not closed, or whose triangles disagree about the outside, has no inside. It is a sheet that is
//   touched from both sides, with a note.
// Set-up only: allocates and throws. Any thread. Cost: some 0.5 us a triangle.
#pragma once

#include <string>
#include <vector>

#include "base/triangle_mesh.hpp"

namespace palpate {

inline constexpr double kThinnest_m = 1e-9;  // least height of a triangle that has a plane [m]
inline constexpr double kLargestMesh_m = 2;  // longest edge of the mesh's bounding box, since queries are in float [m]

struct PreparedMesh {
  TriangleMesh mesh;
  std::vector<Vec3> normals_W;     // of each triangle, unit
  bool closed = false;             // it has an inside
  std::vector<std::string> notes;  // what was changed or may surprise; each begins with the mesh's name
};

// Refuses (Error kBadInput): no triangle, or none left; an index of a vertex that does not exist; a vertex that is not
// finite; a mesh larger than kLargestMesh_m, which hints at a wrong unit.
[[nodiscard]] PreparedMesh prepareMesh(TriangleMesh mesh, const std::string& name);

// Six times the volume that a closed mesh encloses; negative with normals inwards [m^3].
[[nodiscard]] double sixfoldVolume(const TriangleMesh& mesh) noexcept;

}  // namespace palpate
