// SPDX-License-Identifier: Apache-2.0
#include "servo/contact/stiffness_by_density.hpp"

namespace palpate {

Vec3 StiffnessByDensity::move(const ContactState& contact, const Vec3& vhip_W) noexcept {
  if (contact.new_contact) factor_ = 1;
  const WindowSampler& sampler = window_.of(*contact.window);
  const Vec3 below_W =
      contact.plane.nearest(contact.hip_W) - contact.plane.normal_W * (kBelow * sampler.smallestSpacing());
  const Fetch at = sampler.at(below_W);
  if (at.place == Place::kInside) factor_ = table_.factor(at.density);
  return contact.hip_W + factor_ * (vhip_W - contact.hip_W);
}

}  // namespace palpate
