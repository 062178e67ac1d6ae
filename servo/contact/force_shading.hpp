// SPDX-License-Identifier: Apache-2.0
// servo/contact/force_shading.hpp: force shading: between plane renewals the force turns with the surface.
//
// The last VHIP moves along the plane as the tool did. The gradient there gives a shading plane through it. The HIP is
// projected onto the shading plane, which gives HIP'; HIP' is projected onto the true plane, which gives the VHIP.
//
// With the tool at rest this converges to d = D / cos(angle) along the shading normal. Each tick multiplies the error
// by the square of the sine of the angle between the planes. D, the depth below the true plane, is unchanged. On a
// surface of radius R, at lateral speed v, the normal lags that at the HIP by D / (R - D) of v T / R: what the surface
// point gains on the tool in a tick. A plane of age n errs by n v T / (R - D). A lag of a whole tick would drive the
// tool on wherever the surface is hollow.
//
// The VHIP stays as it came in the first tick of a contact, with zero gradient, if it is beyond the window or the
// volume, with a HIP in front of the shading plane, and with a shading normal more than a right angle from the plane's
// (that is another sheet). It is never moved aside by more than kSteepest times the depth: that turns the force by 45
// degrees at most. So where the surface curves within the depth, the projections do not run away. The last VHIP is the
// one made here; what later effects do to it is not on the surface.
//
// Source: Ruspini, Kolarov, Khatib (SIGGRAPH 1997); the paper, section 3.3. Frame W: world [m]. Thread: move() and
// release() the servo's. Cost: a fetch each tick, some 50 ns.
#pragma once

#include "servo/contact/contact_effect.hpp"
#include "servo/contact/window_cache.hpp"

namespace palpate {

class ForceShading final : public ContactEffect {
 public:
  static constexpr double kSteepest = 1;  // way aside / depth [-]

  void release() noexcept override { window_.forget(); }
  void move(const ContactState& contact, ContactPush& push) noexcept override;

 private:
  [[nodiscard]] Vec3 shaded(const ContactState& contact, const Vec3& vhip_W) noexcept;

  WindowCache window_;
  Vec3 last_vhip_W_ = Vec3::Zero();
  Vec3 last_hip_W_ = Vec3::Zero();
};

}  // namespace palpate
