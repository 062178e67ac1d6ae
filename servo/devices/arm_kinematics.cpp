// SPDX-License-Identifier: Apache-2.0
#include "servo/devices/arm_kinematics.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

namespace palpate {
namespace {

constexpr double kLeastDeterminant = 1e-9;  // [m^3]; the arm of 0.1 m links has some 1e-3 in its workspace

// What a motor's turn is of its body's.
double ratio(const ArmJoint& joint) noexcept {
  return (joint.aligned ? -1 : 1) * joint.capstan_m / joint.body_m;
}

}  // namespace

double ArmKinematics::radPerCount(std::size_t joint) const noexcept {
  return 2 * std::numbers::pi / joints_[joint].counts_per_turn * ratio(joints_[joint]);
}

Vec3 ArmKinematics::angles(const ArmCounts& counts) const noexcept {
  Vec3 angles;
  for (std::size_t k = 0; k < 3; ++k) angles[static_cast<int>(k)] = radPerCount(k) * static_cast<double>(counts[k]);
  return angles;
}

Vec3 ArmKinematics::position(const Vec3& angles) const noexcept {
  const double out_m = joints_[1].length_m * std::sin(angles[1]) + joints_[2].length_m * std::sin(angles[2]);
  const double up_m =
      joints_[0].length_m + joints_[1].length_m * std::cos(angles[1]) - joints_[2].length_m * std::cos(angles[2]);
  return Vec3(std::cos(angles[0]) * out_m, std::sin(angles[0]) * out_m, up_m) - origin_m_;
}

Eigen::Matrix3d ArmKinematics::jacobian(const Vec3& angles) const noexcept {
  const double lb = joints_[1].length_m, lc = joints_[2].length_m;
  const double sa = std::sin(angles[0]), ca = std::cos(angles[0]);
  const double sb = std::sin(angles[1]), cb = std::cos(angles[1]);
  const double sc = std::sin(angles[2]), cc = std::cos(angles[2]);
  const double out_m = lb * sb + lc * sc;
  Eigen::Matrix3d j;
  j << -sa * out_m, ca * lb * cb, ca * lc * cc,  //
      ca * out_m, sa * lb * cb, sa * lc * cc,    //
      0, -lb * sb, lc * sc;
  return j;
}

Vec3 ArmKinematics::currents(const Vec3& force_A, const Vec3& angles) const noexcept {
  return (jacobian(angles).transpose() * force_A).cwiseQuotient(bodyTorques());
}

Vec3 ArmKinematics::bodyTorques() const noexcept {
  Vec3 torques;
  for (int k = 0; k < 3; ++k) {
    const ArmJoint& joint = joints_[static_cast<std::size_t>(k)];
    torques[k] = joint.torque_Nm_per_A / ratio(joint);
  }
  return torques;
}

Eigen::Matrix3d ArmKinematics::pushes(const Vec3& angles) const noexcept {
  const Eigen::Matrix3d j = jacobian(angles);
  if (!(std::abs(j.determinant()) > kLeastDeterminant))
    return Eigen::Matrix3d::Constant(std::numeric_limits<double>::infinity());
  return j.transpose().inverse();
}

Vec3 ArmKinematics::force(const Vec3& currents_A, const Vec3& angles) const noexcept {
  const Eigen::Matrix3d j = jacobian(angles);
  if (!(std::abs(j.determinant()) > kLeastDeterminant)) return Vec3::Zero();
  return j.transpose().inverse() * currents_A.cwiseProduct(bodyTorques());
}

// With C' = pi - C, from straight up, the two links are a chain in the plane of the arm: its elbow's angle q = C' - B
// follows from the law of cosines.
std::optional<Vec3> ArmKinematics::anglesAt(const Vec3& position_A) const noexcept {
  const Vec3 p = position_A + origin_m_;
  const double lb = joints_[1].length_m, lc = joints_[2].length_m;
  const double out_m = std::hypot(p.x(), p.y()), up_m = p.z() - joints_[0].length_m;
  const double cosine = (out_m * out_m + up_m * up_m - lb * lb - lc * lc) / (2 * lb * lc);
  if (!(std::abs(cosine) <= 1)) return {};
  const double q = std::acos(cosine);
  const double b = std::atan2(out_m, up_m) - std::atan2(lc * std::sin(q), lb + lc * std::cos(q));
  return Vec3(std::atan2(p.y(), p.x()), b, std::numbers::pi - b - q);
}

ArmCounts ArmKinematics::countsAt(const Vec3& angles) const noexcept {
  ArmCounts counts{};
  for (std::size_t k = 0; k < 3; ++k) counts[k] = std::llround(angles[static_cast<int>(k)] / radPerCount(k));
  return counts;
}

double ArmKinematics::resolution_m(const Vec3& angles) const noexcept {
  const Eigen::Matrix3d j = jacobian(angles);
  double longest_m = 0;
  for (int k = 0; k < 3; ++k)
    longest_m = std::max(longest_m, j.col(k).norm() * std::abs(radPerCount(static_cast<std::size_t>(k))));
  return longest_m;
}

}  // namespace palpate
