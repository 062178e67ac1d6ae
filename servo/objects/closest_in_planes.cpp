// SPDX-License-Identifier: Apache-2.0
#include "servo/objects/closest_in_planes.hpp"

#include <algorithm>
#include <array>
#include <limits>

namespace palpate {
namespace {

// Bounds the rounding of positions below a metre [m].
constexpr double kRounding_m = 1e-12;

// Pushes along the normals of a set of planes that are all active: (G + softness) push = depth, G_ij = N_i . N_j.
class ActiveSet {
 public:
  ActiveSet(std::span<const ContactPlane> planes, const Vec3& hip_W) noexcept : planes_(planes), hip_W_(hip_W) {}

  // Solves for the set. Gives by how much its solution violates the whole problem: a push that pulls, or another plane
  // that is violated [m].
  [[nodiscard]] double solve(std::span<const int> members) noexcept {
    const auto n = members.size();
    Mat3 l = Mat3::Zero();  // L D L^T, the pivots D on its diagonal
    Vec3 push_m = Vec3::Zero();
    for (std::size_t i = 0; i < n; ++i) {
      const auto row = static_cast<int>(i);
      push_m[row] = plane(members[i]).depth(hip_W_);
      for (std::size_t j = 0; j <= i; ++j) {
        const auto column = static_cast<int>(j);
        double g = plane(members[i]).normal_W.dot(plane(members[j]).normal_W);
        if (i == j) g = 1 + kPlaneSoftness;
        for (int k = 0; k < column; ++k) g -= l(row, k) * l(column, k) * l(k, k);
        l(row, column) = i == j ? std::max(g, kPlaneSoftness) : g / l(column, column);
      }
      for (int k = 0; k < row; ++k) push_m[row] -= l(row, k) * push_m[k];
    }
    for (auto i = static_cast<int>(n) - 1; i >= 0; --i) {
      push_m[i] /= l(i, i);
      for (auto k = i + 1; k < static_cast<int>(n); ++k) push_m[i] -= l(k, i) * push_m[k];
    }
    x_W = hip_W_;
    double error_m = 0;
    for (std::size_t i = 0; i < n; ++i) {
      x_W += push_m[static_cast<int>(i)] * plane(members[i]).normal_W;
      error_m = std::max(error_m, -push_m[static_cast<int>(i)]);
    }
    for (int other = 0; other < static_cast<int>(planes_.size()); ++other) {
      if (std::find(members.begin(), members.end(), other) != members.end()) continue;
      error_m = std::max(error_m, plane(other).depth(x_W));
    }
    return error_m;
  }

  Vec3 x_W = Vec3::Zero();  // of the last solve [m]

 private:
  [[nodiscard]] const ContactPlane& plane(int i) const noexcept { return planes_[static_cast<std::size_t>(i)]; }
  std::span<const ContactPlane> planes_;
  Vec3 hip_W_;
};

}  // namespace

// The problem is strictly convex, so the set whose solution violates nothing is the answer. Small sets come first.
Vec3 closestInPlanes(std::span<const ContactPlane> planes, const Vec3& hip_W) noexcept {
  const auto count = static_cast<int>(planes.size());
  if (count == 1) {
    const double depth_m = planes.front().depth(hip_W);
    return depth_m > 0 ? Vec3(hip_W + depth_m / (1 + kPlaneSoftness) * planes.front().normal_W) : hip_W;
  }
  ActiveSet set(planes, hip_W);
  Vec3 best_W = hip_W;
  double best_m = std::numeric_limits<double>::infinity();
  std::array<int, 3> members = {};
  const auto fits = [&](std::size_t size) noexcept {
    const double error_m = set.solve({members.data(), size});
    if (error_m < best_m) {
      best_m = error_m;
      best_W = set.x_W;
    }
    return best_m <= kRounding_m;
  };
  if (fits(0)) return best_W;
  for (members[0] = 0; members[0] < count; ++members[0]) {
    if (fits(1)) return best_W;
  }
  for (members[0] = 0; members[0] < count; ++members[0]) {
    for (members[1] = members[0] + 1; members[1] < count; ++members[1]) {
      if (fits(2)) return best_W;
    }
  }
  for (members[0] = 0; members[0] < count; ++members[0]) {
    for (members[1] = members[0] + 1; members[1] < count; ++members[1]) {
      for (members[2] = members[1] + 1; members[2] < count; ++members[2]) {
        if (fits(3)) return best_W;
      }
    }
  }
  return best_W;
}

}  // namespace palpate
