// SPDX-License-Identifier: Apache-2.0
#include "apps/path/pressed_curve.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>

namespace palpate {
namespace {

constexpr double kPointSmoothingVoxels = 0.75;
constexpr double kNormalSmoothingVoxels = 1.5;
constexpr double kKernelReach = 4;  // standard deviations

using Index = std::ptrdiff_t;

// A sequence continued beyond its ends by point reflection, so that smoothing does not move the ends.
Vec3 continued(const std::vector<Vec3>& v, Index i) {
  const Index last = static_cast<Index>(v.size()) - 1;
  if (i < 0) return 2 * v.front() - v[static_cast<std::size_t>(std::min(-i, last))];
  if (i > last) return 2 * v.back() - v[static_cast<std::size_t>(std::max<Index>(2 * last - i, 0))];
  return v[static_cast<std::size_t>(i)];
}

std::vector<Vec3> smoothed(const std::vector<Vec3>& v, double sigma_steps) {
  const Index reach = static_cast<Index>(std::ceil(kKernelReach * sigma_steps));
  std::vector<double> weight;
  for (Index k = -reach; k <= reach; ++k)
    weight.push_back(std::exp(-0.5 * static_cast<double>(k * k) / (sigma_steps * sigma_steps)));
  double total = 0;
  for (const double w : weight) total += w;
  std::vector<Vec3> out(v.size());
  for (Index i = 0; i < static_cast<Index>(v.size()); ++i) {
    Vec3 sum = Vec3::Zero();
    for (Index k = -reach; k <= reach; ++k) sum += weight[static_cast<std::size_t>(k + reach)] * continued(v, i + k);
    out[static_cast<std::size_t>(i)] = sum / total;
  }
  return out;
}

}  // namespace

PressedCurve::PressedCurve(const SurfaceCurve& surface, double depth_m, double voxel_m) {
  std::vector<Vec3> normals_W;
  for (const SurfaceHit& point : surface.points) {
    points_W_.push_back(point.p_W);
    normals_W.push_back(point.normal_W);
  }
  if (points_W_.size() > 1) {
    points_W_ = smoothed(points_W_, kPointSmoothingVoxels * voxel_m / surface.step_m);
    normals_W = smoothed(normals_W, std::max(kNormalSmoothingVoxels * voxel_m, depth_m) / surface.step_m);
  }
  for (std::size_t i = 0; i < points_W_.size(); ++i) points_W_[i] -= depth_m * normals_W[i];
}

double PressedCurve::shareOutside(const SurfaceField& field) const {
  const auto outside = std::count_if(points_W_.begin(), points_W_.end(),
                                     [&](const Vec3& p_W) { return heightAt(field, p_W).value_or(1) <= 0; });
  return static_cast<double>(outside) / static_cast<double>(points_W_.size());
}

Vec3 PressedCurve::at(double share) const {
  if (points_W_.size() == 1) return points_W_.front();
  const Index last = static_cast<Index>(points_W_.size()) - 1;
  const double place = std::clamp(share, 0.0, 1.0) * static_cast<double>(last);
  const Index i = std::min(static_cast<Index>(place), last - 1);
  const double t = place - static_cast<double>(i);
  const Vec3 p0 = continued(points_W_, i - 1), p1 = continued(points_W_, i);
  const Vec3 p2 = continued(points_W_, i + 1), p3 = continued(points_W_, i + 2);
  const Vec3 m1 = (p2 - p0) / 2, m2 = (p3 - p1) / 2;
  const double t2 = t * t, t3 = t2 * t;
  return (2 * t3 - 3 * t2 + 1) * p1 + (t3 - 2 * t2 + t) * m1 + (3 * t2 - 2 * t3) * p2 + (t3 - t2) * m2;
}

}  // namespace palpate
