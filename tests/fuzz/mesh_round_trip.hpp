// SPDX-License-Identifier: Apache-2.0
// tests/fuzz/mesh_round_trip.hpp: checks that a mesh read from a file is the same when it is written and read again.
#pragma once

#include <algorithm>
#include <string>
#include <string_view>

#include "apps/mesh/mesh_writer.hpp"
#include "fuzz_target.hpp"

namespace palpate::fuzz {

using MeshReader = TriangleMesh (*)(std::string_view bytes, const std::string& file);

// Whether `read` accepts the bytes. Leaves the verdict on the input as it was.
inline bool isRead(MeshReader read, const std::string& bytes, const std::string& name) {
  const Verdict before = verdict;
  const bool is_read = accepts(name, [&] { static_cast<void>(read(bytes, name)); });
  verdict = before;
  return is_read;
}

// Requires that the mesh's numbers are finite and that its triangles name its vertices. Written as a file and read
// again, every triangle must be where it was. `name`: of that file, with the suffix that `read` reads. A file holds
// floats, so the numbers are rounded first.
inline void requireMesh(TriangleMesh mesh, MeshReader read, const std::string& name) {
  for (Vec3& vertex : mesh.vertices_W) {
    require(vertex.allFinite(), "a vertex is not finite");
    vertex = vertex.cast<float>().cast<double>();
    if (!vertex.allFinite()) return;  // a double that no float holds
  }
  for (const auto& triangle : mesh.triangles) {
    for (const std::uint32_t corner : triangle) require(corner < mesh.vertices_W.size(), "a corner is no vertex");
  }
  if (mesh.triangles.empty()) return;
  std::string bytes;
  writeMesh(mesh, name, 1, [&](std::string_view piece) { bytes += piece; });
  mustAccept("its mesh, written again, is refused", [&] {
    const TriangleMesh again = read(bytes, name);
    require(again.triangles.size() == mesh.triangles.size(), "it has another number of triangles when written again");
    for (std::size_t n = 0; n < mesh.triangles.size(); ++n) {
      for (std::size_t corner = 0; corner < 3; ++corner) {
        require(again.vertices_W[again.triangles[n][corner]] == mesh.vertices_W[mesh.triangles[n][corner]],
                "a corner lies elsewhere when written again");
      }
    }
  });
}

}  // namespace palpate::fuzz
