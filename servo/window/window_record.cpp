// SPDX-License-Identifier: Apache-2.0
#include "servo/window/window_record.hpp"

#include <algorithm>
#include <cmath>

namespace palpate {
namespace {

bool holdsCells(const std::int32_t (&size)[3], std::size_t capacity) noexcept {
  std::size_t count = 1;
  for (const std::int32_t side : size) {
    if (side < 2 || static_cast<std::size_t>(side) > capacity / count) return false;
    count *= static_cast<std::size_t>(side);
  }
  return true;
}

// The tolerance of checkLattice(), in the sum over nine products.
bool isLattice(const Lattice& lattice) noexcept {
  if (!lattice.origin_W.allFinite() || !lattice.spacing_m.allFinite() || !lattice.R_WL.allFinite()) return false;
  // As checkLattice() has it: beyond, the sampler's tolerance at faces would reach past the samples.
  const double finest_m = lattice.spacing_m.minCoeff();
  if (!(finest_m >= kFinest_m && lattice.spacing_m.maxCoeff() <= kCoarsest_m)) return false;
  if (!(lattice.origin_W.cwiseAbs().maxCoeff() <= kFarthest_voxel * finest_m)) return false;
  const Mat3 off = lattice.R_WL.transpose() * lattice.R_WL - Mat3::Identity();
  return off.cwiseAbs().maxCoeff() <= 1e-3;
}

}  // namespace

WindowRecord recordOf(const SampleWindow& window) noexcept {
  WindowRecord record;
  for (int axis = 0; axis < 3; ++axis) {
    record.origin_W[axis] = window.lattice.origin_W[axis];
    record.spacing_m[axis] = window.lattice.spacing_m[axis];
    record.size[axis] = window.size[axis];
    const auto i = static_cast<std::size_t>(axis);
    record.low_is_border[axis] = window.low_is_border[i] ? 1 : 0;
    record.high_is_border[axis] = window.high_is_border[i] ? 1 : 0;
  }
  std::copy_n(window.lattice.R_WL.data(), 9, record.axes_WL);
  record.version = window.version;
  record.edit_version = window.edit_version;
  record.stamp_ns = window.stamp_ns;
  return record;
}

SampleWindow windowOf(const WindowRecord& record, const Sample* samples, std::size_t capacity) noexcept {
  SampleWindow window;
  for (int axis = 0; axis < 3; ++axis) {
    window.lattice.origin_W[axis] = record.origin_W[axis];
    window.lattice.spacing_m[axis] = record.spacing_m[axis];
    window.size[axis] = record.size[axis];
    const auto i = static_cast<std::size_t>(axis);
    window.low_is_border[i] = record.low_is_border[axis] != 0;
    window.high_is_border[i] = record.high_is_border[axis] != 0;
  }
  std::copy_n(record.axes_WL, 9, window.lattice.R_WL.data());
  window.version = record.version;
  window.edit_version = record.edit_version;
  window.stamp_ns = record.stamp_ns;
  if (holdsCells(record.size, capacity) && isLattice(window.lattice)) window.samples = samples;
  return window;
}

}  // namespace palpate
