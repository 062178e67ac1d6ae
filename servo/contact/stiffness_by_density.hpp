// SPDX-License-Identifier: Apache-2.0
// servo/contact/stiffness_by_density.hpp: multiplies the contact's K by a factor f of the density: bone is harder than
// cartilage.
//
// On the isosurface the density is the isovalue everywhere. So the density is read kBelow voxels under the surface
// point under the tool, along the felt normal. That is beyond the blur of a border between two materials, which
// is as wide as a voxel in that direction (0.5 mm within a slice, 3 mm from slice to slice).
// On the exact surface the energy U that earlier effects stored becomes f U, so d becomes f d. Where f changes along
// the surface there is a further part, -U grad f, towards the softer material. On a bare plane its force is K / 2 D^2
// |grad f|, that is D |grad f| / (2 f) of the normal force. A hand that slides onto bone feels it: it does the work
// that the bone gives back later.
// - Planes of a sampled surface jump a little, and harder ground would multiply that. So what f has above 1 multiplies
//   the d and the U of the felt surface; only what is softer than K is so for the plane.
// - In a deep press the part along the surface would hold the tool beside a border many times as stiffly as K, without
//   damping: by U times the bend of f, which grows with the square of the depth. A light hand would shake there. So the
//   part is divided by 1 + U b / K, where b is the most that f bends at a border between two materials, and holds by K
//   at most there. For a table from 1 to 3 on voxels of 1 mm it is halved 0.8 mm deep. There the effect has no
//   potential, and the energy account sees to it that a tool that slides onto bone is not pushed harder than it has
//   worked for.
// - f is a smooth field (lattice_spline.hpp) of the samples' factors. So a step in the table becomes one or two voxels
//   wide in space, and the force is continuous.
// - The damping B stays as it is. Without a window the last factor of the contact holds; a contact begins with 1.
//
// Source: stiffness from density as in Avila and Sobierajski (1996), here on the virtual plane, and from a potential.
// Frame W: world [m]. Thread: move() and release() the servo's. Cost: docs/effects.md.
#pragma once

#include "servo/contact/contact_effect.hpp"
#include "servo/contact/felt_field.hpp"
#include "servo/contact/stiffness_table.hpp"

namespace palpate {

class StiffnessByDensity final : public ContactEffect {
 public:
  // How far under the surface the density is read, in units of voxelAcross(). The smooth field reaches 1.5 voxels to
  // either side.
  static constexpr double kBelow = 2.5;

  StiffnessByDensity(StiffnessTable table, double rate_hz)
      : table_(std::move(table)), bend_(table_.range() * LatticeSpline::kBorderBend), field_(rate_hz) {}

  void release() noexcept override {
    factor_ = 1;
    field_.release();
  }
  void move(const ContactState& contact, ContactPush& push) noexcept override;

 private:
  struct Slope {
    Vec3 along_W = Vec3::Zero();  // of f, along the surface, at the HIP [1/m]
    double bend_per_m2 = 0;       // the most that f bends there beside a border
  };
  [[nodiscard]] Slope slopeAtHip(const FeltPoint& felt) noexcept;

  StiffnessTable table_;
  double bend_;        // of f, on voxels with a smallest side of 1 [-]
  FeltField field_;    // of factors
  double factor_ = 1;  // [-]
};

}  // namespace palpate
