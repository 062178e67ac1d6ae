// SPDX-License-Identifier: Apache-2.0
#include "servo/contact/energy_account.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

namespace palpate {
namespace {

constexpr double kTiny_m2 = 1e-30;  // smaller than every energy that matters

}  // namespace

void EnergyAccount::open(const ContactState& contact, const ContactPush& push) noexcept {
  drag_.start(contact);
  last_hip_W_ = contact.hip_W;
  last_d_W_ = push.vhip_W - contact.hip_W;
  last_plane_W_ = contact.plane.nearest(contact.hip_W) - contact.hip_W;
  put_in_m2_ = largest_m2_ = push.energy_m2;
  plane_put_in_m2_ = 0.5 * last_plane_W_.squaredNorm();
  debt_m2_ = drag_limit_m_ = plane_given_m2_ = 0;
}

// Energy that the plane alone has given so far beyond what it took, times its stiffness here.
double EnergyAccount::planeGiven(const Vec3& way_W, const Vec3& plane_W, double stiffness) noexcept {
  plane_put_in_m2_ -= 0.5 * (last_plane_W_ + plane_W).dot(way_W);
  last_plane_W_ = plane_W;
  const double given_m2 = stiffness * std::max(0.0, 0.5 * plane_W.squaredNorm() - plane_put_in_m2_);
  plane_given_m2_ = std::min(given_m2, plane_given_m2_ + kShare * (given_m2 - plane_given_m2_));
  return plane_given_m2_;
}

Vec3 EnergyAccount::settle(const ContactState& contact, const ContactPush& push) noexcept {
  const Vec3 way_W = contact.hip_W - last_hip_W_;
  // A first step whose work is large beside all that is stored is too coarse for the trapezoid rule.
  const bool again = std::exchange(just_opened_, contact.new_contact) &&
                     largest_m2_ < kFirstStep * std::abs((push.vhip_W - contact.hip_W).dot(way_W));
  if (contact.new_contact || again || !isTickMotion(way_W) || !std::isfinite(push.energy_m2) ||
      !std::isfinite(put_in_m2_)) {
    open(contact, push);
    return push.vhip_W;
  }
  const Vec3 plane_W = contact.plane.nearest(contact.hip_W) - contact.hip_W;
  const double plane_given_m2 = planeGiven(way_W, plane_W, push.stiffness);

  drag_.draw(contact);
  const double depth_m = plane_W.norm();
  const double owed_m = depth_m > 0 ? std::min(kRepayments * debt_m2_ / depth_m, kMostDrag * depth_m) : 0;
  drag_limit_m_ += kShare * (owed_m - drag_limit_m_);
  const double stretch_m = drag_.stretch().norm();
  if (stretch_m > drag_limit_m_) drag_.slip(drag_limit_m_ / stretch_m);
  const Vec3 d_W = push.vhip_W - contact.hip_W - drag_.stretch();
  const double energy_m2 = push.energy_m2 + 0.5 * drag_.stretch().squaredNorm();

  // With d multiplied by `strength`, E becomes put_in - (last_d + strength d) . way / 2. The store, strength U, may be
  // at most E plus the free part and what the plane gave.
  const double before_m2 = put_in_m2_ - 0.5 * last_d_W_.dot(way_W);
  const double wanted_m2 = energy_m2 + 0.5 * d_W.dot(way_W);
  const double available_m2 = before_m2 + plane_given_m2 + kFree * std::max(largest_m2_, energy_m2);
  const double strength = wanted_m2 > available_m2 ? std::max(0.0, available_m2) / std::max(wanted_m2, kTiny_m2) : 1;
  last_hip_W_ = contact.hip_W;
  last_d_W_ = strength * d_W;
  put_in_m2_ = before_m2 - 0.5 * last_d_W_.dot(way_W);
  largest_m2_ = std::max(largest_m2_, strength * energy_m2);
  debt_m2_ = std::max(0.0, energy_m2 - put_in_m2_ - plane_given_m2);
  return contact.hip_W + last_d_W_;
}

}  // namespace palpate
