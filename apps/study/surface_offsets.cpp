// SPDX-License-Identifier: Apache-2.0
#include "apps/study/surface_offsets.hpp"

#include <algorithm>
#include <cmath>
#include <optional>

#include "apps/bench/random.hpp"

namespace palpate {
namespace {

constexpr double kFarthest_voxel = 4;
constexpr double kStep_voxel = 0.125;

double trilinear(const reference::DenseField& field, const Vec3& p_L) {
  const Vec3 last = (field.size - Vec3i::Constant(2)).cast<double>();
  const Vec3 base = p_L.array().floor().max(0.0).min(last.array());
  const Vec3i cell = base.cast<int>();
  const Vec3 t = p_L - base;
  double value = 0;
  for (int corner = 0; corner < 8; ++corner) {
    const Vec3i at(corner & 1, corner >> 1 & 1, corner >> 2);
    double weight = 1;
    for (int axis = 0; axis < 3; ++axis) weight *= at[axis] == 1 ? t[axis] : 1 - t[axis];
    value += weight * field.at(cell.x() + at.x(), cell.y() + at.y(), cell.z() + at.z());
  }
  return value;
}

// The crossing next to the point, in either direction along the normal [voxel]. `above`: the field less the isovalue.
template <class Above>
std::optional<double> nearestCrossing(const Above& above) {
  double out = above(0), in = out;
  for (double far = kStep_voxel; far <= kFarthest_voxel; far += kStep_voxel) {
    const double next_out = above(far), next_in = above(-far);
    // A line between two samples, which are an eighth of a voxel apart.
    if ((out > 0) != (next_out > 0)) return far - kStep_voxel * next_out / (next_out - out);
    if ((in > 0) != (next_in > 0)) return -far + kStep_voxel * next_in / (next_in - in);
    out = next_out;
    in = next_in;
  }
  return std::nullopt;
}

}  // namespace

std::vector<ExactSurfacePoint> exactSurfacePoints(const Phantom& phantom, std::size_t count, double border_voxel,
                                                  std::uint64_t seed) {
  constexpr int kNewtonSteps = 20;
  const double close_m = 1e-9 * phantom.lattice().smallestSpacing();
  const Vec3 last_L = (phantom.size() - Vec3i::Ones()).cast<double>();
  Random random(seed);
  std::vector<ExactSurfacePoint> points;
  while (points.size() < count) {
    Vec3 p_L;
    for (int axis = 0; axis < 3; ++axis) p_L[axis] = random.uniform(border_voxel, last_L[axis] - border_voxel);
    Vec3 p_W = phantom.lattice().toWorld(p_L);
    SurfaceOffset at = phantom.offset(p_W);
    for (int step = 0; step < kNewtonSteps && std::abs(at.distance_m) > close_m; ++step) {
      p_W -= at.distance_m * at.normal;
      at = phantom.offset(p_W);
    }
    p_L = phantom.lattice().toIndex(p_W);
    const double border = std::min(p_L.minCoeff(), (last_L - p_L).minCoeff());
    if (std::abs(at.distance_m) <= close_m && border >= border_voxel) points.push_back({p_W, at.normal});
  }
  return points;
}

SurfaceOffsets surfaceOffsets(const reference::DenseField& field, double isovalue,
                              std::span<const ExactSurfacePoint> points) {
  const double voxel_m = field.lattice.smallestSpacing();
  SurfaceOffsets offsets;
  double sum = 0, squares = 0, found = 0;
  for (const ExactSurfacePoint& point : points) {
    const std::optional<double> at = nearestCrossing([&](double along_voxel) {
      const Vec3 p_W = point.p_W + along_voxel * voxel_m * point.normal_W;
      return trilinear(field, field.lattice.toIndex(p_W)) - isovalue;
    });
    offsets.lost += at ? 0 : 1;
    if (!at) continue;
    ++found;
    sum += *at * voxel_m;
    squares += *at * *at * voxel_m * voxel_m;
  }
  offsets.mean_m = sum / found;
  offsets.rms_m = std::sqrt(squares / found);
  return offsets;
}

}  // namespace palpate
