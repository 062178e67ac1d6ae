// SPDX-License-Identifier: Apache-2.0
// servo/contact/sliding_spring.hpp: a spring along the surface, between the tool and a sled that the tool draws behind
// it.
//
// The stretch grows by the tool's own motion along the surface. So the work of the hand against the force -K stretch is
// exactly the spring's energy, K / 2 stretch^2, however the surface curves and its planes jump. Shortening the stretch
// can only take energy away. If several planes hold the tool, the motion of the VHIP draws the spring instead: in a
// corner the tool may move behind a VHIP that stands still. When the normal turns, the stretch is projected onto the
// new surface. That never makes it longer. A wrong reading (isTickMotion) puts the sled back to the tool.
// Frame W: world [m]. Thread: the servo's. Cost: some 5 ns.
#pragma once

#include "servo/contact/contact_effect.hpp"

namespace palpate {

class SlidingSpring {
 public:
  // Puts the sled where the tool is.
  void start(const ContactState& contact) noexcept {
    stretch_W_.setZero();
    remember(contact);
  }

  // Once per tick: the tool has moved.
  void draw(const ContactState& contact) noexcept {
    const Vec3& normal_W = contact.plane.normal_W;
    const Vec3 way_W = contact.single_plane ? Vec3(contact.hip_W - last_hip_W_)
                                            : Vec3(contact.plane.nearest(contact.hip_W) - last_surface_W_);
    if (!isTickMotion(way_W)) return start(contact);
    stretch_W_ += way_W;
    stretch_W_ -= normal_W * normal_W.dot(stretch_W_);
    remember(contact);
  }

  // The sled slips towards the tool: `share` of the stretch is left, 0 to 1.
  void slip(double share) noexcept { stretch_W_ *= share; }

  [[nodiscard]] const Vec3& stretch() const noexcept { return stretch_W_; }  // from the sled to the tool [m]

 private:
  void remember(const ContactState& contact) noexcept {
    last_hip_W_ = contact.hip_W;
    last_surface_W_ = contact.plane.nearest(contact.hip_W);
  }

  Vec3 stretch_W_ = Vec3::Zero();
  Vec3 last_hip_W_ = Vec3::Zero();
  Vec3 last_surface_W_ = Vec3::Zero();
};

}  // namespace palpate
