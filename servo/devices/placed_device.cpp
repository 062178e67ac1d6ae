// SPDX-License-Identifier: Apache-2.0
#include "servo/devices/placed_device.hpp"

#include <algorithm>
#include <cmath>

#include "base/error.hpp"

namespace palpate {
namespace {

const Placement& checked(const Placement& p) {
  checkSetting(p.scale > 0 && std::isfinite(p.scale), "scale of the device's way", p.scale, "give a number above 0");
  checkSetting(p.force_scale > 0 && std::isfinite(p.force_scale), "scale of the device's force", p.force_scale,
               "give a number above 0");
  checkSetting(p.at_W.allFinite(), "place of the device", p.at_W.sum(), "give finite coordinates");
  checkSetting(p.edge_stiffness_N_per_m >= 0 && std::isfinite(p.edge_stiffness_N_per_m), "edge of the workspace",
               p.edge_stiffness_N_per_m, "give 0 N/m (none) or more");
  constexpr double kRounding = 1e-9;
  const double off = (p.R_WD * p.R_WD.transpose() - Eigen::Matrix3d::Identity()).cwiseAbs().maxCoeff();
  checkSetting(off <= kRounding && p.R_WD.determinant() > 0, "turn of the device", off, "give a rotation");
  return p;
}

}  // namespace

Eigen::Matrix3d facingThePatient() {
  Eigen::Matrix3d axes;
  axes << 1, 0, 0,  //
      0, 0, -1,     //
      0, 1, 0;
  return axes;
}

PlacedDevice::PlacedDevice(std::shared_ptr<Device> device, const Placement& placement)
    : device_(std::move(device)),
      placement_(checked(placement)),
      radius_m_(device_->limits().workspace_radius_m),
      begins_at_place_(!device_->limits().follows_force) {}

DeviceLimits PlacedDevice::limits() const noexcept {
  DeviceLimits limits = device_->limits();
  limits.force_limit_N /= placement_.force_scale;
  limits.slew_limit_N_per_s /= placement_.force_scale;
  limits.position_resolution_m *= placement_.scale;
  limits.stiffness_limit_N_per_m /= placement_.scale * placement_.force_scale;
  limits.workspace_radius_m *= placement_.scale;
  limits.motion.speed_m_per_s *= placement_.scale;
  limits.motion.acceleration_m_per_s2 *= placement_.scale;
  return limits;
}

std::vector<HandParameters> PlacedDevice::hands() const {
  std::vector<HandParameters> hands = device_->hands();
  const double smaller = 1 / (placement_.scale * placement_.force_scale);
  for (HandParameters& hand : hands) {
    for (double* value : {&hand.hand_mass_kg, &hand.hand_damping_Ns_per_m, &hand.hand_stiffness_N_per_m,
                          &hand.device_mass_kg, &hand.device_damping_Ns_per_m})
      *value *= smaller;
    hand.device_friction_N /= placement_.force_scale;
  }
  return hands;
}

ForceOff PlacedDevice::forceOff() const noexcept {
  const ForceOff why = device_->forceOff();
  if (why != ForceOff::kNone) return why;
  return was_clutched_.load(std::memory_order_relaxed) ? ForceOff::kClutched : ForceOff::kNone;
}

void PlacedDevice::beginEdge() noexcept {
  edge_m_ = std::max(radius_m_, position_D_.norm());
}

void PlacedDevice::beginAnew() noexcept {
  beginEdge();
  device_->beginAnew();
}

bool PlacedDevice::read(Vec3& position_W) noexcept {
  Vec3 position_D = position_D_;
  if (!device_->read(position_D)) {
    was_off_ = was_off_ || forceOff() != ForceOff::kNone;
    return false;
  }
  const bool clutched = this->clutched();
  if (!has_read_ && begins_at_place_) shift_D_ = position_D;
  if (has_read_ && (clutched || was_clutched_.load(std::memory_order_relaxed))) shift_D_ += position_D - position_D_;
  was_clutched_.store(clutched, std::memory_order_relaxed);
  has_read_ = true;
  position_D_ = position_D;
  const bool is_off = forceOff() != ForceOff::kNone;
  if (is_off || was_off_) beginEdge();
  edge_m_ = std::max(radius_m_, std::min(edge_m_, position_D_.norm()));
  was_off_ = is_off;
  position_W = placement_.at_W + placement_.scale * (placement_.R_WD * (position_D_ - shift_D_));
  return true;
}

DeviceBoundary PlacedDevice::boundary() const noexcept {
  const double far_m = position_D_.norm();
  if (!(radius_m_ > 0) || far_m <= edge_m_ || clutched()) return {};
  const double beyond_m = far_m - edge_m_;
  const double force_N = placement_.edge_stiffness_N_per_m * beyond_m;
  const Vec3 force_D = -force_N / far_m * position_D_;
  return {placement_.R_WD * force_D / placement_.force_scale,
          0.5 * force_N * beyond_m * placement_.scale / placement_.force_scale};
}

Vec3 PlacedDevice::toDevice(const Vec3& force_W) const noexcept {
  if (clutched()) return Vec3::Zero();
  return placement_.force_scale * (placement_.R_WD.transpose() * force_W);
}

bool PlacedDevice::write(const Vec3& force_W) noexcept {
  return device_->write(toDevice(force_W));
}

Vec3 PlacedDevice::held(const Vec3& force_W) const noexcept {
  return placement_.R_WD * device_->held(toDevice(force_W)) / placement_.force_scale;
}

}  // namespace palpate
