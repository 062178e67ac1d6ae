// SPDX-License-Identifier: Apache-2.0
// tests/servo/contact/plane_contact.hpp: one effect on the plane z = 0, without an algorithm: VHIP and force for a HIP.
#pragma once

#include <vector>

#include "servo/contact/contact_effect.hpp"

namespace palpate {

// T is the frame of the test, so that a test can be repeated in a turned frame: x_W = R_WT * x_T.
class PlaneContact {
 public:
  explicit PlaneContact(ContactEffect& effect, const Mat3& R_WT = Mat3::Identity(), double isovalue = 0)
      : effect_(effect), felt_(isovalue, 1000), R_WT_(R_WT) {}

  // One tick with the HIP at `hip_T`, in contact: the VHIP after the effect, in T.
  Vec3 at(const Vec3& hip_T) {
    ContactState contact;
    contact.hip_W = R_WT_ * hip_T;
    contact.plane = {R_WT_ * plane_T.p_W, R_WT_ * plane_T.normal_W, age_ticks_++};
    contact.new_contact = new_contact_;
    contact.felt = felt_.feel({.hip_W = contact.hip_W,
                               .plane = contact.plane,
                               .begins = new_contact_,
                               .on_volume = !plane_is_felt,
                               .window = window});
    if (plane_is_felt && window->usable()) contact.felt.window = window;
    new_contact_ = false;
    const double depth_m = contact.plane.depth(contact.hip_W);
    push = {.vhip_W = contact.plane.nearest(contact.hip_W),
            .surface_d_W = depth_m * contact.plane.normal_W,
            .energy_m2 = 0.5 * depth_m * depth_m};
    effect_.move(contact, push);
    return R_WT_.transpose() * push.vhip_W;
  }
  void renew(const ContactPlane& plane) {
    plane_T = plane;
    age_ticks_ = 0;
  }
  void leave() {
    effect_.release();
    felt_.release();
    new_contact_ = true;
    age_ticks_ = 0;
  }

  ContactPlane plane_T{Vec3::Zero(), Vec3::UnitZ(), 0};
  bool plane_is_felt = false;  // whatever the samples say of the surface
  const SampleWindow* window = &none_;
  ContactPush push;  // after the last tick, in W

 private:
  ContactEffect& effect_;
  FeltSurface felt_;
  Mat3 R_WT_;
  SampleWindow none_;
  bool new_contact_ = true;
  std::int32_t age_ticks_ = 0;
};

inline Mat3 someRotation() {
  return (Eigen::AngleAxisd(1.1, Vec3(0.3, -0.5, 0.8).normalized()) * Eigen::AngleAxisd(-0.4, Vec3::UnitY()))
      .toRotationMatrix();
}

// A tool that wanders about over the plane z = 0, 0 to 2 mm deep, up to 0.2 mm along each axis in a tick.
// Deterministic.
inline std::vector<Vec3> wander(int ticks, std::uint32_t seed = 1) {
  std::uint32_t state = seed;
  const auto uniform = [&] {  // Numerical Recipes' linear congruence
    state = state * 1664525u + 1013904223u;
    return static_cast<double>(state >> 8) / (1 << 24) * 2 - 1;
  };
  std::vector<Vec3> way;
  Vec3 hip(0, 0, -1e-3);
  for (int i = 0; i < ticks; ++i) {
    const double x = uniform(), y = uniform(), z = uniform();
    hip += 0.2e-3 * Vec3(x, y, z);
    hip.z() = std::clamp(hip.z(), -2e-3, 0.0);
    way.push_back(hip);
  }
  return way;
}

}  // namespace palpate
