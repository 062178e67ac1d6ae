// SPDX-License-Identifier: Apache-2.0
// base/triangle_mesh.hpp: a surface made of triangles, and what makes it fit to be touched or stamped.
//
// Set-up only: allocates and throws. Any thread.
#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "base/vec.hpp"

namespace palpate {

// A mesh as importers and the isosurface mesher give it. Frame: world W [m], or the frame of a file before the mesh is
// placed. Seen from outside, a triangle's corners go counter-clockwise. Plain data without guarantees: prepareMesh()
// checks it.
struct TriangleMesh {
  std::vector<Vec3> vertices_W;                         // [m]
  std::vector<std::array<std::uint32_t, 3>> triangles;  // indices into vertices_W
};

inline constexpr double kThinnest_m = 1e-9;  // least height of a triangle that has a plane [m]
inline constexpr double kLargestMesh_m = 2;  // longest edge of the mesh's bounding box, since queries are in float [m]

struct PreparedMesh {
  TriangleMesh mesh;
  std::vector<Vec3> normals_W;     // of each triangle, unit
  bool closed = false;             // it has an inside
  std::vector<std::string> notes;  // what was changed or may surprise; each begins with the mesh's name
};

// Makes a mesh fit to be touched or stamped:
// - Vertices at one place become one, so that neighbours share edges (STL repeats every vertex).
// - Triangles without a plane are dropped, with a note. Two of their corners are at one place, or they are thinner than
//   kThinnest_m.
// - A mesh is closed if its triangles pass every edge as often in one direction as in the other. A closed mesh with
//   inward normals (negative volume) is turned, with a note.
// - A mesh that is not closed, or whose triangles disagree about the outside, has no inside. It is a sheet that can be
//   touched from both sides, with a note.
// Refuses (Error kBadInput): no triangle, or none left; an index of a vertex that does not exist; a vertex that is not
// finite; a mesh larger than kLargestMesh_m, which hints at a wrong unit. Cost: some 0.5 us a triangle.
[[nodiscard]] PreparedMesh prepareMesh(TriangleMesh mesh, const std::string& name);

// Six times the volume that a closed mesh encloses; negative with inward normals [m^3].
[[nodiscard]] double sixfoldVolume(const TriangleMesh& mesh) noexcept;

}  // namespace palpate
