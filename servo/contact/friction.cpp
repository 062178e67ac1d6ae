// SPDX-License-Identifier: Apache-2.0
#include "servo/contact/friction.hpp"

namespace palpate {

Friction::Friction(const FrictionParameters& parameters, double stiffness_N_per_m, double rate_hz) noexcept
    : static_ratio_(parameters.static_ratio),
      dynamic_ratio_(parameters.dynamic_ratio),
      share_(parameters.viscous_Ns_per_m > 0
                 ? stiffness_N_per_m / (stiffness_N_per_m + parameters.viscous_Ns_per_m * rate_hz)
                 : 1.0),
      still_m_(kStill / rate_hz) {}

void Friction::release() noexcept {
  slipping_ = false;
}

Vec3 Friction::move(const ContactState& contact, const Vec3& vhip_W) noexcept {
  const Vec3& normal_W = contact.plane.normal_W;
  const double depth_m = normal_W.dot(vhip_W - contact.hip_W);
  if (contact.new_contact || !(depth_m > 0)) {
    slipping_ = false;
    sled_W_ = vhip_W;
    return vhip_W;
  }
  const Vec3 to_target_W = vhip_W - sled_W_;
  const Vec3 t_W = to_target_W - normal_W * normal_W.dot(to_target_W);
  const double t_m = t_W.norm();
  double lag_m = t_m;
  if (slipping_ || t_m > static_ratio_ * depth_m) {
    const double way_m = share_ * (t_m - dynamic_ratio_ * depth_m);
    slipping_ = way_m > still_m_;
    if (slipping_) lag_m -= way_m;
  }
  sled_W_ = t_m > 0 ? Vec3(vhip_W - t_W * (lag_m / t_m)) : vhip_W;
  return sled_W_;
}

}  // namespace palpate
