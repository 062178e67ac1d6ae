// SPDX-License-Identifier: Apache-2.0
// servo/contact/contact_effect.hpp: the interface of contact effects: friction, texture, recovery, force shading and
// stiffness by density. An effect moves the VHIP and nothing else.
//
// An algorithm in contact first puts the VHIP on its plane. Then each effect moves the VHIP in turn. The force follows
// from the result: F = K d with d = VHIP - HIP. Without effects this costs one comparison per tick.
//
// A surface must not give back more energy than a hand put in. So an effect whose strength depends on the place has a
// potential U. Its d is minus the slope of U / K, along the normal and along the surface. The energy that the effects
// so far have stored is passed on beside the VHIP, as U / K = `energy_m2`. For the bare plane at depth D it is D^2 / 2.
// An effect cannot derive it from |d|, since d also has parts along the surface. Recovery, force shading and planes
// that jump have no potential. The energy account watches them (energy_account.hpp).
//
// Source: the paper, sections 3.1 (last paragraph) and 3.3. Frame W: world [m, m/s]. Thread: the servo's; no heap,
// lock, system call or throw. An effect gets the servo's period, a stiffness or a number of ticks when it is made.
#pragma once

#include <memory>
#include <vector>

#include "base/vec.hpp"
#include "servo/contact/contact_plane.hpp"
#include "servo/contact/felt_surface.hpp"

namespace palpate {

struct ContactState {
  Vec3 hip_W = Vec3::Zero();           // [m]
  Vec3 hip_velocity_W = Vec3::Zero();  // [m/s]
  ContactPlane plane;                  // if several planes hold the tool: through the VHIP, normal from the HIP to it
  bool new_contact = false;            // first tick of a contact
  bool single_plane = true;            // one plane alone holds the tool
  bool on_volume = true;               // only the volume's isosurface holds it, no other object
  FeltPoint felt;                      // all that effects know of the surface under the tool, if one asks
};

// The contact as the plane and the effects so far have made it.
struct ContactPush {
  Vec3 vhip_W = Vec3::Zero();  // [m]
  // d of the surface alone: plane and force shading, without what later effects lay over them [m].
  Vec3 surface_d_W = Vec3::Zero();
  double energy_m2 = 0;  // U / K: energy that the tool gets back if it is drawn straight out
  double stiffness = 1;  // stiffness of the contact here, over K [-]
};

class ContactEffect {
 public:
  virtual ~ContactEffect() = default;
  // Whether it reads ContactState::felt. Where no effect does, nobody looks for it.
  [[nodiscard]] virtual bool feelsSurface() const noexcept { return true; }
  // The contact has ended: forgets it.
  virtual void release() noexcept = 0;
  // Moves the VHIP from where the plane and earlier effects put it, and updates the stored energy.
  virtual void move(const ContactState& contact, ContactPush& push) noexcept = 0;
};

using ContactEffects = std::vector<std::unique_ptr<ContactEffect>>;

}  // namespace palpate
