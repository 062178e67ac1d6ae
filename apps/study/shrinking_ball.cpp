// SPDX-License-Identifier: Apache-2.0
#include "apps/study/shrinking_ball.hpp"

#include <algorithm>
#include <cmath>

namespace palpate {
namespace {

constexpr double kRamp_voxel = 3;

}  // namespace

SampleWindow windowOf(const ShrinkingBall& ball, double t_s, const Vec3& place_W, int edge, std::uint64_t version,
                      std::vector<Sample>& storage) {
  const Vec3i first = (place_W / ball.voxel_m - Vec3::Constant(0.5 * (edge - 1))).array().round().matrix().cast<int>();
  const double radius_m = ball.radiusAt_m(t_s), slope_per_m = kBallContrast / (kRamp_voxel * ball.voxel_m);
  // With a border of one sample for the differences.
  const int wide = edge + 2;
  std::vector<float> densities(static_cast<std::size_t>(wide) * wide * wide);
  const auto at = [&](int i, int j, int k) -> float& {
    return densities[(static_cast<std::size_t>(k) * wide + j) * wide + i];
  };
  for (int k = 0; k < wide; ++k) {
    for (int j = 0; j < wide; ++j) {
      for (int i = 0; i < wide; ++i) {
        const double distance_m =
            ((first + Vec3i(i, j, k) - Vec3i::Ones()).cast<double>() * ball.voxel_m).norm() - radius_m;
        at(i, j, k) = static_cast<float>(std::clamp(-slope_per_m * distance_m, -kBallContrast, kBallContrast));
      }
    }
  }
  const auto per_2h = static_cast<float>(1 / (2 * ball.voxel_m));
  storage.clear();
  for (int k = 1; k <= edge; ++k) {
    for (int j = 1; j <= edge; ++j) {
      for (int i = 1; i <= edge; ++i) {
        storage.push_back({(at(i + 1, j, k) - at(i - 1, j, k)) * per_2h, (at(i, j + 1, k) - at(i, j - 1, k)) * per_2h,
                           (at(i, j, k + 1) - at(i, j, k - 1)) * per_2h, at(i, j, k)});
      }
    }
  }
  SampleWindow window;
  window.lattice.origin_W = first.cast<double>() * ball.voxel_m;
  window.lattice.spacing_m = Vec3::Constant(ball.voxel_m);
  window.size = Vec3i::Constant(edge);
  window.version = window.edit_version = version;
  window.samples = storage.data();
  return window;
}

double BallTool::depthAt_m(double t_s) const {
  return -kAir_m + (depth_m + kAir_m) * std::min(t_s / kApproach_s, 1.0);
}

Vec3 BallTool::directionAt(const ShrinkingBall& ball, double t_s) const {
  const double angle_rad = speed_m_per_s * t_s / ball.radius_m;
  return std::cos(angle_rad) * towards + std::sin(angle_rad) * aside;
}

Vec3 BallTool::positionAt_W(const ShrinkingBall& ball, double t_s) const {
  return (ball.radiusAt_m(t_s) - depthAt_m(t_s)) * directionAt(ball, t_s);
}

}  // namespace palpate
