// SPDX-License-Identifier: Apache-2.0
// servo/contact/stiffness_by_density.hpp: bone is harder than cartilage: the contact's K times a factor of the density.
//
// On the isosurface the density is the isovalue everywhere, so it is looked up kBelow voxels under the surface point
// nearest to the HIP, along the plane's normal: beyond the blur of a border between two materials. The VHIP moves along
// the line through the HIP, so d = VHIP - HIP is multiplied by the factor, with all that earlier effects did to it: the
// friction cone keeps its angle, which is why this effect is the last. The damping B stays as it is.
// Where the window or the volume ends before that depth, the contact's last factor holds, 1 at its beginning.
// Source: stiffness from density as in Avila and Sobierajski (1996), here without leaving the virtual plane.
// Frame W: world [m]. Thread: move() and release() the servo's. Cost: a fetch each tick, some 30 ns.
#pragma once

#include "servo/contact/contact_effect.hpp"
#include "servo/contact/stiffness_table.hpp"
#include "servo/contact/window_cache.hpp"

namespace palpate {

class StiffnessByDensity final : public ContactEffect {
 public:
  static constexpr double kBelow = 2;  // the surface [voxel, the smallest side]

  explicit StiffnessByDensity(StiffnessTable table) : table_(std::move(table)) {}

  void release() noexcept override { factor_ = 1; }
  [[nodiscard]] Vec3 move(const ContactState& contact, const Vec3& vhip_W) noexcept override;

 private:
  StiffnessTable table_;
  WindowCache window_;
  double factor_ = 1;  // [-]
};

}  // namespace palpate
