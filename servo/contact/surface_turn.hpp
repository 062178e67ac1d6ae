// SPDX-License-Identifier: Apache-2.0
// servo/contact/surface_turn.hpp: how the surface's normal turns along it, and what that makes of slopes on the
// surface.
//
// With p the surface point nearest to the HIP x, N the normal there and D the depth, x = p - D N. Along the surface
// dN = S dp, S the shape operator, 1 / R on a ball; so dx = (I - D S) dp: under a ball the surface point moves faster
// than the tool, R / (R - D) times. What has the slope q along the surface at p has the slope (I - D S)^-1 q at x. A
// force that leaves this out gives energy where the place under the tool matters.
// S is read from the sampled gradients a voxel aside, either way along two tangents; where one is not to be had the
// surface counts as flat. A tool as deep as the surface is round would be under all of it at once: no slope is
// multiplied by more than kMostTimes.
// Frame W: world [m]. Thread: the servo's. Cost: four fetches, some 170 ns. Errors: none.
#pragma once

#include "servo/window/window_sampler.hpp"

namespace palpate {

class SurfaceTurn {
 public:
  static constexpr double kMostTimes = 4;  // [-]

  // Flat.
  explicit SurfaceTurn(const Vec3& normal_W) noexcept;
  // As the window of `sampler` has it at the surface point p.
  SurfaceTurn(const WindowSampler& sampler, const Vec3& p_W, const Vec3& normal_W) noexcept;

  // S v, of the part of v along the surface [v per m].
  [[nodiscard]] Vec3 turn(const Vec3& v_W) const noexcept;
  // The slope at the HIP, D deep, of what has the slope `q_W` at p; of its part along the surface.
  [[nodiscard]] Vec3 atHip(const Vec3& q_W, double depth_m) const noexcept;

 private:
  void setTangents(const Vec3& normal_W, const Vec3& other_W) noexcept;

  Vec3 u_W_, v_W_;                   // tangents, unit
  double uu_ = 0, uv_ = 0, vv_ = 0;  // S along them [1/m]
};

// How wide a voxel is across a plane with this unit normal, as the root of the sum of squares: so far it blurs a border
// with that normal. A side of the voxel where the normal lies along it [m].
[[nodiscard]] inline double voxelAcross(const Lattice& lattice, const Vec3& normal_W) noexcept {
  return (lattice.R_WL.transpose() * normal_W).cwiseProduct(lattice.spacing_m).norm();
}

}  // namespace palpate
