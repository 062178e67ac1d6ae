// SPDX-License-Identifier: Apache-2.0
#include "servo/contact/force_shading.hpp"

#include <algorithm>
#include <cmath>

namespace palpate {

void ForceShading::move(const ContactState& contact, ContactPush& push) noexcept {
  const Vec3& normal_W = contact.plane.normal_W;
  const double cosine = contact.felt.normal_W.dot(normal_W);
  const double depth_m = normal_W.dot(push.vhip_W - contact.hip_W);
  if (!(cosine > 0) || !(depth_m > 0)) return;
  const Vec3 aside_W = contact.felt.normal_W - cosine * normal_W;  // as long as the sine of the angle
  const double sine = aside_W.norm();
  if (!(sine > 0)) return;
  const double tangent = std::min({sine / cosine, kMostTurned, 2 * cosine});
  const double aside_m = tangent * depth_m;
  const Vec3 turn_W = aside_m / sine * aside_W;
  push.vhip_W += turn_W;
  push.surface_d_W += turn_W;
}

}  // namespace palpate
