// SPDX-License-Identifier: Apache-2.0
// servo/contact/contact_effect.hpp: what friction, texture, recovery, force shading and stiffness by density have in
// common: they move the VHIP and nothing else.
//
// An algorithm in contact first puts the VHIP on its plane. Then it lets each effect move the VHIP in turn, and
// computes the force from the result: F = K d with d = VHIP - HIP. Without effects this costs one comparison per tick.
//
// A surface must not give back more energy than a hand put in. So an effect whose strength depends on the place has a
// potential U, and its d is minus the slope of U / K, along the normal and along the surface. The energy stored by the
// effects so far is passed on beside the VHIP, as U / K = `energy_m2`; for the bare plane of depth D it is D^2 / 2. An
// effect cannot derive it from |d|, since d also has parts along the surface. Recovery, force shading and planes that
// jump have no potential; the energy account watches them (energy_account.hpp).
//
// Source: the paper, sections 3.1 (last paragraph) and 3.3. Frame W: world [m, m/s]. Thread: the servo's; no heap,
// lock, system call or throw. An effect gets the servo's period, a stiffness or a number of ticks when it is made.
#pragma once

#include <memory>
#include <vector>

#include "base/vec.hpp"
#include "servo/contact/contact_plane.hpp"
#include "servo/window/sample_window.hpp"

namespace palpate {

// The longest way that a tool can go in a tick. If two positions are farther apart, one of them is a wrong reading, and
// sums over the way start anew [m].
inline constexpr double kLongestTickWay_m = 0.1;

// Whether this is a true motion of the tool in a tick. False for NaN too.
[[nodiscard]] inline bool isAWay(const Vec3& way_W) noexcept {
  return way_W.cwiseAbs().maxCoeff() <= kLongestTickWay_m && way_W.allFinite();
}

struct ContactState {
  Vec3 hip_W = Vec3::Zero();             // [m]
  Vec3 hip_velocity_W = Vec3::Zero();    // [m/s]
  ContactPlane plane;                    // if several planes hold the tool: through the VHIP, normal from the HIP to it
  bool new_contact = false;              // first tick of a contact
  bool single_plane = true;              // one plane alone holds the tool
  bool on_volume = true;                 // only the volume's isosurface holds it, no other object
  const SampleWindow* window = nullptr;  // of this tick; never null, may be unusable
};

// What the plane and the effects so far make of the contact.
struct ContactPush {
  Vec3 vhip_W = Vec3::Zero();  // [m]
  double energy_m2 = 0;        // U / K: energy that the tool would get back if it were drawn straight out
  double stiffness = 1;        // stiffness of the contact here, over K [-]
};

class ContactEffect {
 public:
  virtual ~ContactEffect() = default;
  // There is no contact: forget the last one.
  virtual void release() noexcept = 0;
  // Moves the VHIP from where the plane and earlier effects put it, and updates the stored energy.
  virtual void move(const ContactState& contact, ContactPush& push) noexcept = 0;
};

using ContactEffects = std::vector<std::unique_ptr<ContactEffect>>;

}  // namespace palpate
