// SPDX-License-Identifier: Apache-2.0
// engine/field/mesh_distance.hpp: a closed triangle mesh as signed distances on a lattice, by OpenVDB's mesh to
// volume. Frame: the mesh's own [m]. Any thread. Cost: follows the mesh's surface in voxels; some 10 ms for 64^3.
#pragma once

#include <vector>

#include "base/lattice.hpp"
#include "base/vec.hpp"

namespace palpate {

// Signed distances [m], negative inside. Beyond the band and depth they were asked for they only keep their sign.
struct MeshDistance {
  Vec3i size = Vec3i::Zero();  // [voxel], i fastest
  Lattice lattice;
  std::vector<float> distance_m;  // size.prod() of them
};

inline constexpr int kMaxMeshVoxels = 512;  // along an axis

// `band_m`: how far outside the surface distances are true; the lattice reaches as far around the mesh. `depth_m`: how
// far inside. Refuses (Error kBadInput): no triangles, a corner that does not exist or is no number, a voxel size, band
// or depth that is not positive, a mesh that would need more than kMaxMeshVoxels voxels along an axis.
[[nodiscard]] MeshDistance meshDistance(const std::vector<Vec3>& points, const std::vector<Vec3i>& triangles,
                                        double voxel_m, double band_m, double depth_m);

}  // namespace palpate
