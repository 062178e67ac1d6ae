// SPDX-License-Identifier: Apache-2.0
// servo/contact/stiffness_by_density.hpp: bone is harder than cartilage: the contact's K times a factor of the density.
//
// On the isosurface the density is the isovalue everywhere, so it is looked up kBelow voxels under the surface point
// nearest to the HIP, along the plane's normal: beyond the blur of a border between two materials, which is as wide
// as a voxel is in that direction (0.5 mm in a slice, 3 mm from one to the next).
// The energy stored becomes f U, with all that earlier effects stored; so d becomes f d, and where f changes along the
// surface there is a part -U grad f besides, towards what is softer: K / 2 D^2 |grad f| on a bare plane, D |grad f| / 2
// f of the normal force. That is what a hand feels as it slides onto bone: it has to do the work that bone gives back.
// f is a smooth field (lattice_spline.hpp) of the samples' factors, so that a step in the table is one or two voxels
// wide in space, and the force is continuous. The damping B stays as it is.
// Without a window the contact's last factor holds, 1 at its beginning.
// Source: stiffness from density as in Avila and Sobierajski (1996), here without leaving the virtual plane, and from a
// potential. Frame W: world [m]. Thread: move() and release() the servo's. Cost: 4 fetches and a smooth field of 27
// rows of the table, some 270 ns.
#pragma once

#include "servo/contact/contact_effect.hpp"
#include "servo/contact/lattice_spline.hpp"
#include "servo/contact/stiffness_table.hpp"
#include "servo/contact/window_cache.hpp"

namespace palpate {

class StiffnessByDensity final : public ContactEffect {
 public:
  // Under the surface [voxel across, voxelAcross()]. The smooth field reaches 1.5 voxels to either side.
  static constexpr double kBelow = 2.5;

  explicit StiffnessByDensity(StiffnessTable table) : table_(std::move(table)) {}

  void release() noexcept override {
    factor_ = 1;
    window_.forget();
    field_.forget();
  }
  void move(const ContactState& contact, ContactPush& push) noexcept override;

 private:
  [[nodiscard]] Vec3 slopeAtHip(const ContactState& contact) noexcept;

  StiffnessTable table_;
  WindowCache window_;
  LatticeSpline field_;  // of factors
  double factor_ = 1;    // [-]
};

}  // namespace palpate
