// SPDX-License-Identifier: Apache-2.0
// apps/bench/flat_volume.hpp: the volumes of the edit bench: the same plane surface in cubes of any size. Any thread.
#pragma once

#include <algorithm>

#include <fmt/format.h>

#include "engine/field/volume.hpp"

namespace palpate::flat_volume {

inline constexpr double kIsovalue = 0.5;
inline constexpr double kSpacing_m = 1e-3;
inline constexpr double kPlane_voxel = 3.5;  // height above the volume's middle: the middle of a layer of bricks

// Fills one brick: 512 values. If the brick is constant, only the first value, and returns true.
inline bool brick(int size, const Vec3i& brick, float* values) {
  constexpr double kRamp_voxel = 4;
  const int middle = size / 2;
  const double surface = middle + kPlane_voxel;
  const auto at = [&](int k) {
    return static_cast<float>(std::clamp(0.5 + (surface - brick.z() * kBrickSize - k) / kRamp_voxel, 0.0, 1.0));
  };
  values[0] = at(0);
  if (at(0) == at(kBrickSize - 1)) return true;
  for (int n = 0; n < kBrickVoxels; ++n) values[n] = at(n / (kBrickSize * kBrickSize));
  return false;
}

// A cube of 1 mm voxels. The density is 1 below the plane z = size / 2 + 3.5 voxels and 0 above it, with a ramp of four
// voxels between. The ramp lies in one layer of bricks; all other bricks are constant.
[[nodiscard]] inline Volume make(int size) {
  Lattice lattice;
  lattice.spacing_m = Vec3::Constant(kSpacing_m);
  VolumeFacts facts;
  facts.source = fmt::format("a plane in {0} x {0} x {0} voxels", size);
  return Volume::fromBricks(Vec3i::Constant(size), lattice, std::move(facts),
                            [size](const Vec3i& at, float* values) { return brick(size, at, values); });
}

}  // namespace palpate::flat_volume
