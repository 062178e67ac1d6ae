// SPDX-License-Identifier: Apache-2.0
// servo/contact/force_shading.hpp: force shading: between plane renewals the force turns with the surface.
//
// The last VHIP goes along the plane as the tool did; the gradient there gives a shading plane through it. The HIP is
// projected on it, to a temporary HIP', and HIP' on the true plane: that is the VHIP. With the tool at rest this
// converges, by the square of the sine of the angle between the planes each tick, to d = D / cos(angle) along the
// shading normal: D is the depth, and the depth below the true plane is unchanged. On a surface of radius R, a tool D
// deep at lateral speed v, the normal is that at the HIP but for what the surface point gains on the tool in a tick, D
// / (R - D) of v T / R, where a plane of age n errs by n v T / (R - D). A lag of a whole tick would drive the tool on
// wherever the surface is hollow. Where it leaves the VHIP as it came: in the first tick of a contact, with zero
// gradient, a VHIP beyond the window or the volume, a HIP in front of the shading plane, and a shading normal more than
// a right angle from the plane's (that is another sheet). It never moves the VHIP aside by more than kSteepest times
// the depth: the force is turned by 45 degrees at most, so where the surface is more curved than the tool is deep the
// projections do not run away. Its VHIP is the one that it made itself: what later effects do to it is not on the
// surface. Source: Ruspini, Kolarov, Khatib (SIGGRAPH 1997), the paper, section 3.3. Frame W: world [m]. Thread: move()
// and release() the servo's. Cost: a fetch each tick, some 50 ns.
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
