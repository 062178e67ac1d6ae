// SPDX-License-Identifier: Apache-2.0
// servo/contact/surface_turn.hpp: how the surface's normal turns along it, and what that does to slopes along the
// surface.
//
// p is the surface point nearest to the HIP x, N the normal there and D the depth, so x = p - D N. Along the surface dN
// = S dp, where S is the shape operator (1 / R on a ball). So dx = (I - D S) dp: in a ball the surface point moves
// faster than the tool, R / (R - D) times. A quantity with the slope q along the surface at p has the slope (I - D
// S)^-1 q at x. A force that leaves this out gives energy wherever it depends on the place under the tool.
// S is read from the sampled gradients one voxel aside, either way along two tangents. If one of them is not available
// the surface counts as flat. For a tool as deep as the surface's radius the slope would grow without bound, so no
// slope is multiplied by more than kMostTimes.
// Frame W: world [m]. Thread: the servo's. Cost: four fetches, some 170 ns. Errors: none.
#pragma once

#include "servo/window/window_sampler.hpp"

namespace palpate {

class SurfaceTurn {
 public:
  static constexpr double kMostTimes = 4;  // [-]

  // A flat surface.
  explicit SurfaceTurn(const Vec3& normal_W) noexcept;
  // The surface in the window of `sampler`, at the surface point p.
  SurfaceTurn(const WindowSampler& sampler, const Vec3& p_W, const Vec3& normal_W) noexcept;

  // S applied to the part of v along the surface [unit of v, per m].
  [[nodiscard]] Vec3 turn(const Vec3& v_W) const noexcept;
  // The slope at the HIP, at this depth, of a quantity with the slope `q_W` at p. Only the part of q_W along the
  // surface counts.
  [[nodiscard]] Vec3 atHip(const Vec3& q_W, double depth_m) const noexcept;

 private:
  void setTangents(const Vec3& normal_W, const Vec3& other_W) noexcept;

  Vec3 u_W_, v_W_;                   // tangents, unit
  double uu_ = 0, uv_ = 0, vv_ = 0;  // S along them [1/m]
};

// The width of a voxel across a plane with this unit normal: the root of the sum of squares of its sides, each times
// the normal's component along it. A border with that normal is blurred so far. If the normal lies along a side, it is
// that side [m].
[[nodiscard]] inline double voxelAcross(const Lattice& lattice, const Vec3& normal_W) noexcept {
  return (lattice.R_WL.transpose() * normal_W).cwiseProduct(lattice.spacing_m).norm();
}

}  // namespace palpate
