// SPDX-License-Identifier: Apache-2.0
// servo/contact/contact_effect.hpp: what friction, texture, recovery and force shading are: they move the VHIP, nothing
// else.
//
// An algorithm that is in contact first puts the VHIP on its plane, then lets each effect move it in turn, then
// computes the force from it. Without effects this costs one comparison per tick. Source: the paper, sections 3.1 (last
// paragraph) and 3.3. Frame W: world [m, m/s]. Thread: the servo's; no heap, lock, system call or throw; a period of
// the servo, a stiffness or a number of ticks that an effect needs it gets when it is made.
#pragma once

#include <memory>
#include <vector>

#include "base/vec.hpp"
#include "servo/contact/contact_plane.hpp"
#include "servo/window/sample_window.hpp"

namespace palpate {

struct ContactState {
  Vec3 hip_W = Vec3::Zero();             // [m]
  Vec3 hip_velocity_W = Vec3::Zero();    // [m/s]
  ContactPlane plane;                    // of several at once: through their VHIP, normal from the HIP to it
  bool new_contact = false;              // first tick of a contact
  bool single_plane = true;              // one plane alone holds the tool
  bool on_volume = true;                 // all that holds it is the volume's isosurface, no other object
  const SampleWindow* window = nullptr;  // of this tick; never null, may be unusable
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
