// SPDX-License-Identifier: Apache-2.0
#include "servo/algorithms/cell_walk.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace palpate {

CellWalk::CellWalk(const Vec3& from_L, const Vec3& to_L, const Vec3& last_L) noexcept
    : from_L_(from_L), way_L_(to_L - from_L) {
  for (int axis = 0; axis < 3; ++axis) {
    const double from = from_L[axis];
    const double way = way_L_[axis];
    if (way == 0) {
      if (from < 0 || from > last_L[axis]) leaves_ = -1;  // misses the lattice
      continue;
    }
    const double low = (0 - from) / way;
    const double high = (last_L[axis] - from) / way;
    enters_ = std::max(enters_, std::min(low, high));
    leaves_ = std::min(leaves_, std::max(low, high));
  }
  for (int axis = 0; axis < 3; ++axis) {
    const double at = from_L[axis] + enters_ * way_L_[axis];
    plane_L_[axis] = way_L_[axis] > 0 ? std::floor(at) + 1 : std::ceil(at) - 1;
  }
  t_ = enters_ > 0 && enters_ < leaves_ ? -1 : 0;
}

double CellWalk::crossing(int axis) const noexcept {
  const double way = way_L_[axis];
  return way == 0 ? std::numeric_limits<double>::infinity() : (plane_L_[axis] - from_L_[axis]) / way;
}

double CellWalk::next() noexcept {
  if (t_ < 0) return t_ = enters_;
  if (!(enters_ < leaves_) || t_ >= leaves_) return t_ = 1;
  double first = leaves_;
  for (int axis = 0; axis < 3; ++axis) {
    // Skips borders where the last step ended: by rounding, or because several axes have one there.
    while (crossing(axis) <= t_) plane_L_[axis] += way_L_[axis] > 0 ? 1 : -1;
    first = std::min(first, crossing(axis));
  }
  return t_ = first;
}

}  // namespace palpate
