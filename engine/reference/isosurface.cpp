// SPDX-License-Identifier: Apache-2.0
#include "engine/reference/isosurface.hpp"

#include <algorithm>
#include <cmath>

namespace palpate::reference {
namespace {

bool inDomain(const DenseField& field, const Vec3& p_L) {
  return (p_L.array() >= 0).all() && (p_L.array() <= field.size.cast<double>().array() - 1).all();
}

}  // namespace

double trilinear(const DenseField& field, const Vec3& p_L) {
  Vec3 f;
  Vec3i cell;
  for (int axis = 0; axis < 3; ++axis) {
    const double p = std::clamp(p_L[axis], 0.0, field.size[axis] - 1.0);
    cell[axis] = std::min(static_cast<int>(p), field.size[axis] - 2);
    f[axis] = p - cell[axis];
  }
  double density = 0;
  for (int corner = 0; corner < 8; ++corner) {
    const Vec3i d(corner & 1, corner >> 1 & 1, corner >> 2);
    double weight = 1;
    for (int axis = 0; axis < 3; ++axis) weight *= d[axis] == 1 ? f[axis] : 1 - f[axis];
    density += weight * field.at(cell.x() + d.x(), cell.y() + d.y(), cell.z() + d.z());
  }
  return density;
}

std::optional<double> firstHit(const DenseField& field, double isovalue, const Vec3& eye_W, const Vec3& direction_W,
                               double step_voxels, const std::function<bool(const Vec3& p_W)>& kept) {
  const double step_m = step_voxels * field.lattice.smallestSpacing();
  const Vec3 centre_W = field.lattice.toWorld((field.size.cast<double>().array() - 1) / 2);
  const double radius_m = (field.size.cast<double>().cwiseProduct(field.lattice.spacing_m)).norm();
  const double end_m = (centre_W - eye_W).norm() + radius_m;
  const auto inside = [&](double t_m) {
    const Vec3 p_W = eye_W + t_m * direction_W, p_L = field.lattice.toIndex(p_W);
    return inDomain(field, p_L) && (!kept || kept(p_W)) && trilinear(field, p_L) > isovalue;
  };
  for (double t_m = 0; t_m < end_m; t_m += step_m) {
    if (!inside(t_m)) continue;
    double low = std::max(0.0, t_m - step_m);
    double high = t_m;
    for (int i = 0; i < 40; ++i) {
      const double middle = 0.5 * (low + high);
      (inside(middle) ? high : low) = middle;
    }
    return high;
  }
  return std::nullopt;
}

}  // namespace palpate::reference
