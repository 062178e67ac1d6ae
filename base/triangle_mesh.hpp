// SPDX-License-Identifier: Apache-2.0
// base/triangle_mesh.hpp: a surface made of triangles, as importers and the isosurface mesher hand it over.
//
// Frame: world W [m], or the frame of a file before it is placed. Seen from outside, a triangle's corners go
// counter-clockwise. Plain data without guarantees: whoever uses a mesh checks it.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "base/vec.hpp"

namespace palpate {

struct TriangleMesh {
  std::vector<Vec3> vertices_W;                         // [m]
  std::vector<std::array<std::uint32_t, 3>> triangles;  // indices into vertices_W
};

}  // namespace palpate
