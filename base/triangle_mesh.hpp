// SPDX-License-Identifier: Apache-2.0
// base/triangle_mesh.hpp: a surface made of triangles, as importers and the isosurface mesher hand it over.
//
// Frame: world W [m], or the frame of a file before it is placed. A triangle's corners go around its outward normal
// counter-clockwise. Plain data; nothing is promised about it: who uses a mesh checks it.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "base/vec.hpp"

namespace palpate {

struct TriangleMesh {
  std::vector<Vec3> vertices_W;                         // [m]
  std::vector<std::array<std::uint32_t, 3>> triangles;  // numbers of vertices
};

}  // namespace palpate
