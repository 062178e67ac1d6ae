// SPDX-License-Identifier: Apache-2.0
// servo/contact/contact_effect.hpp: what friction, texture, recovery and force shading are: they move the VHIP, nothing
// else.
//
// An algorithm that is in contact first puts the VHIP on its plane, then lets each effect move it in turn, then
// computes the force from it, F = K d with d = VHIP - HIP. Without effects this costs one comparison per tick.
//
// So that a surface gives back no more energy than a hand put in, an effect whose strength depends on the place has a
// potential, and its d is minus the slope of that potential: along the normal and along the surface. What the effects
// before it stored is passed on beside the VHIP, as U / K = `energy_m2`; for the bare plane that is D^2 / 2. An effect
// cannot take it from |d|, since d also has parts along the surface. What no potential covers (recovery, force shading,
// planes that jump) the energy account sees (energy_account.hpp).
//
// Source: the paper, sections 3.1 (last paragraph) and 3.3. Frame W: world [m, m/s]. Thread: the servo's; no heap,
// lock, system call or throw; a period of the servo, a stiffness or a number of ticks that an effect needs it gets when
// it is made.
#pragma once

#include <memory>
#include <vector>

#include "base/vec.hpp"
#include "servo/contact/contact_plane.hpp"
#include "servo/window/sample_window.hpp"

namespace palpate {

// A tool that went farther in a tick did not: one of the two positions is a wrong reading, and sums over the way begin
// anew [m].
inline constexpr double kLongestTickWay_m = 0.1;

// False for what is not a number, too.
[[nodiscard]] inline bool isAWay(const Vec3& way_W) noexcept {
  return way_W.cwiseAbs().maxCoeff() <= kLongestTickWay_m && way_W.allFinite();
}

struct ContactState {
  Vec3 hip_W = Vec3::Zero();             // [m]
  Vec3 hip_velocity_W = Vec3::Zero();    // [m/s]
  ContactPlane plane;                    // of several at once: through their VHIP, normal from the HIP to it
  bool new_contact = false;              // first tick of a contact
  bool single_plane = true;              // one plane alone holds the tool
  bool on_volume = true;                 // all that holds it is the volume's isosurface, no other object
  const SampleWindow* window = nullptr;  // of this tick; never null, may be unusable
};

// What pushes the tool so far.
struct ContactPush {
  Vec3 vhip_W = Vec3::Zero();  // [m]
  double energy_m2 = 0;        // U / K: what the tool would get back if it were drawn straight out
  double stiffness = 1;        // of the contact here, over K [-]
};

class ContactEffect {
 public:
  virtual ~ContactEffect() = default;
  // No contact: forget the VHIP of the last one.
  virtual void release() noexcept = 0;
  // Moves the VHIP on from where plane and earlier effects put it, and says what is stored then.
  virtual void move(const ContactState& contact, ContactPush& push) noexcept = 0;
};

using ContactEffects = std::vector<std::unique_ptr<ContactEffect>>;

}  // namespace palpate
