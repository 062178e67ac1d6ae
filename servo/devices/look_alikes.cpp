// SPDX-License-Identifier: Apache-2.0
#include "servo/devices/look_alikes.hpp"

#include <algorithm>
#include <limits>

namespace palpate {
namespace {

constexpr double kBeyond_rad = 0.05;  // more than a push turns a joint: no arm ceases to be one that it may be by that

Vec3 sortedSizes(const Vec3& v) noexcept {
  Vec3 sizes = v.cwiseAbs();
  std::sort(sizes.begin(), sizes.end());
  return sizes;
}

bool canBeAt(const LookAlikes::Arm& arm, const Vec3& angles, double beyond_rad) noexcept {
  for (std::size_t k = 0; k < 3; ++k) {
    const double angle = angles[static_cast<int>(k)];
    if (!(angle >= arm.lowest_rad[k] - beyond_rad && angle <= arm.highest_rad[k] + beyond_rad)) return false;
  }
  return true;
}

}  // namespace

bool LookAlikes::isPossible(const ArmCounts& counts) const noexcept {
  return canBeAt(arms_.front(), arms_.front().arm.angles(counts), 0);
}

double LookAlikes::most_N(const Vec3& currents_A, const ArmCounts& counts) const noexcept {
  return most_N(currents_A, counts, false);
}

double LookAlikes::mostOfPossible_N(const Vec3& currents_A, const ArmCounts& counts) const noexcept {
  return most_N(currents_A, counts, true);
}

// The largest current through the motor that makes most of it, and so on: no order of the motors makes more.
double LookAlikes::most_N(const Vec3& currents_A, const ArmCounts& counts, bool only_possible) const noexcept {
  const Vec3 sizes_A = sortedSizes(currents_A);
  double most_N = 0;
  for (const Arm& other : arms_) {
    ArmCounts its_counts = counts;
    for (std::size_t k = 0; k < 3; ++k) its_counts[k] += other.home_counts[k] - arms_.front().home_counts[k];
    const Vec3 angles = other.arm.angles(its_counts);
    if (only_possible && !canBeAt(other, angles, kBeyond_rad)) continue;
    const Eigen::Matrix3d pushes = other.arm.pushes(angles);
    if (!pushes.allFinite()) return sizes_A.isZero(0) ? 0 : std::numeric_limits<double>::infinity();
    const Vec3 each_N_per_A = pushes.colwise().norm().transpose().cwiseProduct(other.arm.bodyTorques());
    most_N = std::max(most_N, sizes_A.dot(sortedSizes(each_N_per_A)));
  }
  return most_N;
}

}  // namespace palpate
