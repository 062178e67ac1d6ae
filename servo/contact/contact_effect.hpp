// SPDX-License-Identifier: Apache-2.0
// servo/contact/contact_effect.hpp: what friction, texture, recovery and force shading are: they move the VHIP, nothing
// else.
//
// An algorithm that is in contact first puts the VHIP on its plane, then lets each effect move it in turn, then
// computes the force from it. Without effects this costs one comparison per tick. Source: the paper, sections 3.1 (last
// paragraph) and 3.3. Frame W: world [m, m/s]. Thread: the servo's; no heap, lock, system call or throw.
#pragma once

#include <memory>
#include <vector>

#include "base/vec.hpp"

namespace palpate {

struct ContactState {
  Vec3 hip_W = Vec3::Zero();           // [m]
  Vec3 hip_velocity_W = Vec3::Zero();  // [m/s]
  Vec3 plane_point_W = Vec3::Zero();   // [m]
  Vec3 normal_W = Vec3::Zero();        // unit, out of the object [-]
  bool new_contact = false;            // first tick of a contact
  bool new_plane = false;              // the plane was found in this tick
};

class ContactEffect {
 public:
  virtual ~ContactEffect() = default;
  // No contact: forget the VHIP of the last one.
  virtual void release() noexcept = 0;
  // Where the VHIP shall be, given where plane and earlier effects put it [m].
  [[nodiscard]] virtual Vec3 move(const ContactState& contact, const Vec3& vhip_W) noexcept = 0;
};

using ContactEffects = std::vector<std::unique_ptr<ContactEffect>>;

}  // namespace palpate
