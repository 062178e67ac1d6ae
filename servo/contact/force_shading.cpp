// SPDX-License-Identifier: Apache-2.0
#include "servo/contact/force_shading.hpp"

#include <cmath>

namespace palpate {

Vec3 ForceShading::shaded(const ContactState& contact, const Vec3& vhip_W) noexcept {
  if (contact.new_contact || !contact.on_volume) return vhip_W;
  const Vec3& normal_W = contact.plane.normal_W;
  const Vec3 way_W = contact.hip_W - last_hip_W_;
  const Vec3 under_W = last_vhip_W_ + way_W - normal_W * normal_W.dot(way_W);
  const Fetch at_vhip = window_.of(*contact.window).at(under_W);
  const double steepness = at_vhip.gradient_W.norm();
  if (at_vhip.place != Place::kInside || !(steepness > 0) || !std::isfinite(steepness)) return vhip_W;
  const Vec3 shading_W = at_vhip.gradient_W / -steepness;
  const double cosine = shading_W.dot(normal_W);
  const double rise_m = shading_W.dot(under_W - contact.hip_W);  // from the HIP to HIP'
  if (!(cosine > 0) || !(rise_m > 0)) return vhip_W;
  // HIP' on the true plane is the HIP's own projection plus the part of the rise along the plane.
  Vec3 aside_W = rise_m * (shading_W - cosine * normal_W);
  const double aside_m = aside_W.norm();
  const double farthest_m = kSteepest * normal_W.dot(vhip_W - contact.hip_W);
  if (!(farthest_m > 0)) return vhip_W;
  if (aside_m > farthest_m) aside_W *= farthest_m / aside_m;
  return vhip_W + aside_W;
}

void ForceShading::move(const ContactState& contact, ContactPush& push) noexcept {
  push.vhip_W = last_vhip_W_ = shaded(contact, push.vhip_W);
  last_hip_W_ = contact.hip_W;
}

}  // namespace palpate
