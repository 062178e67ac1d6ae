// SPDX-License-Identifier: Apache-2.0
// servo/contact/force_shading.hpp: force shading: between plane renewals the force turns with the surface.
//
// The VHIP of the last tick moves along the plane as the tool did. The gradient there gives a shading plane through it.
// The HIP is projected onto the shading plane, which gives HIP'. HIP' is projected onto the true plane, which gives the
// new VHIP.
//
// With the tool at rest this converges to d = D / cos(angle) along the shading normal. The angle is the one between the
// two planes, D the depth below the true plane, which does not change. Each tick multiplies the error by the square of
// the angle's sine. On a surface of radius R, at lateral speed v, the surface point gains D / (R - D) of v T on the
// tool in a tick. So the normal lags that at the HIP by the angle of that gain, v T D / (R (R - D)). A plane of age n
// alone errs by n v T / (R - D). A normal that lagged by a whole tick would drive the tool on wherever the surface is
// hollow.
//
// The VHIP stays as it came
// - in the first tick of a contact,
// - with zero gradient, or with the VHIP beyond the window or the volume,
// - with the HIP in front of the shading plane,
// - with a shading normal that is more than a right angle from the plane's (that is another sheet).
// It is never moved aside by more than kSteepest times the depth. That turns the force by at most 45 degrees. So the
// projections cannot run away where the radius of the surface is smaller than the depth. The last VHIP is the one made
// here. Later effects move it off the surface, so theirs is not used.
//
// Source: Ruspini, Kolarov, Khatib (SIGGRAPH 1997); the paper, section 3.3. Frame W: world [m]. Thread: move() and
// release() the servo's. Cost: a fetch each tick, some 50 ns.
#pragma once

#include "servo/contact/contact_effect.hpp"
#include "servo/contact/window_cache.hpp"

namespace palpate {

class ForceShading final : public ContactEffect {
 public:
  static constexpr double kSteepest = 1;  // longest move aside / depth [-]

  void release() noexcept override { window_.forget(); }
  void move(const ContactState& contact, ContactPush& push) noexcept override;

 private:
  [[nodiscard]] Vec3 shaded(const ContactState& contact, const Vec3& vhip_W) noexcept;

  WindowCache window_;
  Vec3 last_vhip_W_ = Vec3::Zero();
  Vec3 last_hip_W_ = Vec3::Zero();
};

}  // namespace palpate
