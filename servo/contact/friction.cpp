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

void Friction::move(const ContactState& contact, ContactPush& push) noexcept {
  const double depth_m = contact.plane.normal_W.dot(push.vhip_W - contact.hip_W);
  if (contact.new_contact || !(depth_m > 0)) {
    slipping_ = false;
    spring_.start(contact);
    return;
  }
  spring_.draw(contact);
  const double t_m = spring_.stretch().norm();
  if (slipping_ || t_m > static_ratio_ * depth_m) {
    const double way_m = share_ * (t_m - dynamic_ratio_ * depth_m);
    slipping_ = way_m > still_m_;
    if (slipping_) spring_.slip(1 - way_m / t_m);
  }
  push.vhip_W -= spring_.stretch();
  push.energy_m2 += 0.5 * spring_.stretch().squaredNorm();
}

}  // namespace palpate
