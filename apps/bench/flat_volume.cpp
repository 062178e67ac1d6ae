// SPDX-License-Identifier: Apache-2.0
#include "apps/bench/flat_volume.hpp"

#include <algorithm>

#include <fmt/format.h>

namespace palpate::flat_volume {
namespace {

constexpr double kRamp_voxel = 4;

}  // namespace

bool brick(int size, const Vec3i& brick, float* values) {
  const double surface = size / 2 + kPlane_voxel;
  const auto at = [&](int k) {
    return static_cast<float>(std::clamp(0.5 + (surface - brick.z() * kBrickSize - k) / kRamp_voxel, 0.0, 1.0));
  };
  values[0] = at(0);
  if (at(0) == at(kBrickSize - 1)) return true;
  for (int n = 0; n < kBrickVoxels; ++n) values[n] = at(n / (kBrickSize * kBrickSize));
  return false;
}

Volume make(int size) {
  Lattice lattice;
  lattice.spacing_m = Vec3::Constant(kSpacing_m);
  VolumeFacts facts;
  facts.source = fmt::format("a plane in {0} x {0} x {0} voxels", size);
  return Volume::fromBricks(Vec3i::Constant(size), lattice, std::move(facts),
                            [size](const Vec3i& at, float* values) { return brick(size, at, values); });
}

}  // namespace palpate::flat_volume
