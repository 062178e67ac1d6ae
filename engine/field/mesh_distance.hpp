// SPDX-License-Identifier: Apache-2.0
// engine/field/mesh_distance.hpp: turns a closed triangle mesh into signed distances on a lattice, with OpenVDB's
// meshToVolume. Frame: the mesh's own [m]. Any thread. Cost: in proportion to the mesh's area; some 10 ms for 64^3.
#pragma once

#include <vector>

#include "base/lattice.hpp"
#include "base/vec.hpp"

namespace palpate {

// Signed distances [m], negative inside. Farther from the surface than the requested band and depth only the sign is
// right.
struct MeshDistance {
  Vec3i size = Vec3i::Zero();  // [voxel], i fastest
  Lattice lattice;
  std::vector<float> distance_m;  // size.prod() of them
};

inline constexpr int kMaxMeshVoxels = 512;  // along an axis

// `band_m`: how far outside the surface distances are exact; the lattice extends as far around the mesh. `depth_m`: how
// far inside they are exact. Throws Error(kBadInput) for a mesh without triangles; a corner that does not exist or is
// not finite; a voxel size, band or depth that is not positive; and more than kMaxMeshVoxels voxels along an axis.
[[nodiscard]] MeshDistance meshDistance(const std::vector<Vec3>& points, const std::vector<Vec3i>& triangles,
                                        double voxel_m, double band_m, double depth_m);

}  // namespace palpate
