// SPDX-License-Identifier: Apache-2.0
// base/lattice.hpp: where the samples of a regular grid lie in the world.
//
// W is the world: the patient frame in DICOM's sense (LPS: +x left, +y posterior, +z superior), metres, right-handed.
// L is the lattice's own frame: its axes are the grid's i, j, k directions, its unit is the voxel. The centre of sample
// (i, j, k) has the L coordinates (i, j, k). The axes are orthogonal. They may be left-handed (det R_WL = -1).
#pragma once

#include "base/vec.hpp"

namespace palpate {

struct Lattice {
  Vec3 origin_W = Vec3::Zero();             // centre of sample (0, 0, 0) [m]
  Mat3 R_WL = Mat3::Identity();             // columns: unit directions of i, j, k in the world [-]
  Vec3 spacing_m = Vec3::Constant(1.0e-3);  // distance between samples along i, j, k [m]

  // World position [m] of a point given in voxels, and back. Cost: 9 multiply-adds. Any thread.
  [[nodiscard]] Vec3 toWorld(const Vec3& p_L) const noexcept { return origin_W + R_WL * p_L.cwiseProduct(spacing_m); }
  [[nodiscard]] Vec3 toIndex(const Vec3& p_W) const noexcept {
    return (R_WL.transpose() * (p_W - origin_W)).cwiseQuotient(spacing_m);
  }

  // Turns a gradient from the lattice's axes to the world's; both are per metre.
  [[nodiscard]] Vec3 gradientToWorld(const Vec3& gradient_per_m) const noexcept { return R_WL * gradient_per_m; }

  // The same lattice with sample `first` as its (0, 0, 0): that of a window into a volume.
  [[nodiscard]] Lattice shifted(const Vec3i& first) const noexcept {
    return {toWorld(first.cast<double>()), R_WL, spacing_m};
  }

  [[nodiscard]] double smallestSpacing() const noexcept { return spacing_m.minCoeff(); }  // [m]
};

// A box along the world's axes.
struct WorldBox {
  Vec3 low_W = Vec3::Zero(), high_W = Vec3::Zero();  // [m]
};
// The smallest one that holds the centres of all samples of a grid of `size` [voxel], at least one along each axis.
[[nodiscard]] WorldBox worldBoxOf(const Lattice& lattice, const Vec3i& size);

// Voxels are from 1 pm to 10 km. At kFarthest_voxel from the world's origin doubles are 2e-5 voxels apart, a thousandth
// of what algorithms tell apart; neighbouring voxels would soon be one.
inline constexpr double kFinest_m = 1e-12, kCoarsest_m = 1e4;  // [m]
inline constexpr double kFarthest_voxel = 1e11;

// Throws Error(kBadInput) unless the spacing and the distance from the origin are within these limits and the axes are
// orthonormal within 1e-4. Files with six-digit direction cosines need that tolerance. `input` names the file in the
// message.
void checkLattice(const Lattice& lattice, const std::string& input);

}  // namespace palpate
