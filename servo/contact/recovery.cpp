// SPDX-License-Identifier: Apache-2.0
#include "servo/contact/recovery.hpp"

#include <algorithm>
#include <cmath>

namespace palpate {
namespace {

constexpr auto kLongestUnits = static_cast<std::int64_t>(Recovery::kLongest / Recovery::kUnit);

}  // namespace

Recovery::Recovery(int ticks) : ticks_(ticks), ending_(static_cast<std::size_t>(ticks), Units::Zero()) {}

void Recovery::release() noexcept {
  forget();
}

// Only pending jumps fill slots; without any there is nothing to clear.
void Recovery::forget() noexcept {
  if (pending_ticks_ > 0) std::fill(ending_.begin(), ending_.end(), Units::Zero());
  pending_ticks_ = 0;
  largest_m_ = 0;
  offset_.setZero();
  slope_.setZero();
}

void Recovery::decay() noexcept {
  if (pending_ticks_ == 0) return;
  --pending_ticks_;
  largest_m_ -= largest_m_ / static_cast<double>(ticks_);
  offset_ -= slope_;
  slot_ = slot_ + 1 == ending_.size() ? 0 : slot_ + 1;
  slope_ -= ending_[slot_];
  ending_[slot_].setZero();
  // Jumps of opposite sign that end at different times may leave a larger offset; see kLongest.
  if (offset_.cwiseAbs().maxCoeff() > kLongestUnits) forget();
}

// Called after decay(). So a jump begins whole, and its N shares are gone N ticks from now.
void Recovery::takeUp(const Vec3& jump_W) noexcept {
  if (!jump_W.allFinite() || !((jump_W + offset()).cwiseAbs().maxCoeff() < kLongest)) {
    forget();
    return;
  }
  const double units_per_m = 1 / (kUnit * static_cast<double>(ticks_));
  const Units share(std::llround(jump_W.x() * units_per_m), std::llround(jump_W.y() * units_per_m),
                    std::llround(jump_W.z() * units_per_m));
  if (share.isZero()) return;
  offset_ += share * ticks_;
  slope_ += share;
  ending_[slot_] += share;  // the slot comes round in N ticks
  pending_ticks_ = ticks_;
  largest_m_ = std::max(largest_m_, jump_W.norm());
}

// What is left of the offset where the tool may soon leave the surface.
Vec3 Recovery::offsetAt(double depth_m, const Vec3& normal_W) const noexcept {
  const Vec3 offset_W = offset();
  const double most_m = largest_m_ + std::max(0.0, depth_m);
  const double out_m = offset_W.dot(normal_W);
  const Vec3 aside_W = offset_W - out_m * normal_W;
  const double aside_m = aside_W.norm();
  return std::min(out_m, most_m) * normal_W + (aside_m > most_m ? Vec3(aside_W * (most_m / aside_m)) : aside_W);
}

void Recovery::move(const ContactState& contact, ContactPush& push) noexcept {
  const Vec3 d_W = push.vhip_W - contact.hip_W;
  if (contact.new_contact) {
    forget();
  } else {
    decay();
    if (contact.plane.age_ticks == 0 && contact.single_plane && last_single_) {
      const Vec3 motion_W = contact.hip_W - last_hip_W_;
      takeUp(last_d_W_ - last_normal_W_ * last_normal_W_.dot(motion_W) - d_W);
    }
  }
  last_d_W_ = d_W;
  last_hip_W_ = contact.hip_W;
  last_normal_W_ = contact.plane.normal_W;
  last_single_ = contact.single_plane;
  if (pending_ticks_ == 0) return;
  const Vec3& normal_W = contact.plane.normal_W;
  const Vec3 kept_W = d_W + offsetAt(normal_W.dot(d_W), normal_W);
  const double depth_m = normal_W.dot(kept_W);
  push.vhip_W = contact.hip_W + kept_W - normal_W * std::min(0.0, depth_m);
  push.energy_m2 = 0.5 * std::max(0.0, depth_m) * std::max(0.0, depth_m);
}

}  // namespace palpate
