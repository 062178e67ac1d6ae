// SPDX-License-Identifier: Apache-2.0
// servo/contact/force_shading.hpp: force shading: between plane renewals the force turns with the surface.
//
// The VHIP moves along the plane to where d = VHIP - HIP lies along the felt normal (felt_surface.hpp): d = D /
// cos(angle) along it, with the angle between the two normals and D the depth below the plane, which does not change.
// So the force turns in every tick, not with every plane. The published method gets there step by step: the tool is
// projected onto a shading plane and back. The felt surface knows the normal under the tool, so no step is needed.
//
// The VHIP is never moved aside by more than kMostTurned times the depth. That turns the force by at most 30 degrees. A
// felt normal that is farther away belongs to a sharp edge, where the plane turns faster than the felt surface, or to
// another sheet: from 73 degrees on the move shrinks, and at 90 there is none.
//
// Source: Ruspini, Kolarov, Khatib (SIGGRAPH 1997); the paper, section 3.3. Frame W: world [m]. Thread: move() and
// release() the servo's. Cost: some 10 ns.
#pragma once

#include "servo/contact/contact_effect.hpp"

namespace palpate {

class ForceShading final : public ContactEffect {
 public:
  static constexpr double kMostTurned = 0.57735;  // longest move aside / depth: the tangent of 30 degrees [-]

  void release() noexcept override {}
  void move(const ContactState& contact, ContactPush& push) noexcept override;
};

}  // namespace palpate
