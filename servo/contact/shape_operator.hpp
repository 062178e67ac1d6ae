// SPDX-License-Identifier: Apache-2.0
// servo/contact/shape_operator.hpp: how the surface's normal turns along it, and what that does to slopes along the
// surface.
//
// p is the surface point nearest to the HIP x, N the normal there and D the depth, so x = p - D N. Along the surface dN
// = S dp, where S is the shape operator (1 / R on a ball). So dx = (I - D S) dp: in a ball the surface point moves
// faster than the tool, R / (R - D) times. A quantity with the slope q along the surface at p has the slope (I - D
// S)^-1 q at x. An effect whose force depends on the place under the tool gives energy if it leaves this out.
// For a tool as deep as the surface's radius the slope would grow without bound. So no slope is multiplied by more than
// kMostGrowth.
// Frame W: world [m]. Thread: the servo's. Cost: some 10 ns. Errors: none.
#pragma once

#include "base/lattice.hpp"

namespace palpate {

class ShapeOperator {
 public:
  static constexpr double kMostGrowth = 4;  // [-]

  // A flat surface.
  explicit ShapeOperator(const Vec3& normal_W) noexcept;
  // `S_W`: symmetric [1/m]; only its part along the surface counts.
  ShapeOperator(const Vec3& normal_W, const Mat3& S_W) noexcept;

  // S applied to the part of v along the surface: how N changes over that displacement [unit of v, per m].
  [[nodiscard]] Vec3 apply(const Vec3& v_W) const noexcept;
  // The slope at the HIP of a quantity that has the slope `q_W` at p. Only the part of q_W along the surface counts.
  [[nodiscard]] Vec3 slopeAtHip(const Vec3& q_W, double depth_m) const noexcept;

 private:
  Vec3 u_W_, v_W_;                   // tangents, unit
  double uu_ = 0, uv_ = 0, vv_ = 0;  // S along them [1/m]
};

// The width over which sampling blurs a border with this unit normal [m]. Each side of the voxel is multiplied by the
// normal's component along it; the width is the root of the sum of squares. If the normal lies along a side, it is that
// side.
[[nodiscard]] inline double voxelAcross(const Lattice& lattice, const Vec3& normal_W) noexcept {
  return (lattice.R_WL.transpose() * normal_W).cwiseProduct(lattice.spacing_m).norm();
}

}  // namespace palpate
