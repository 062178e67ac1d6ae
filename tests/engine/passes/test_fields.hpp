// SPDX-License-Identifier: Apache-2.0
// Volumes that the pass tests share: sizes that are no multiple of the brick, spacing that differs by axis.
#pragma once

#include <cfloat>
#include <cmath>
#include <random>
#include <string>
#include <vector>

#include "engine/field/volume.hpp"

namespace palpate {

inline Lattice testLattice() {
  Lattice lattice;
  lattice.origin_W = {0.01, -0.02, 0.03};
  lattice.spacing_m = {0.7e-3, 0.9e-3, 1.3e-3};
  return lattice;
}

template <typename Density>
Volume makeField(const Vec3i& size, Density density) {
  std::vector<float> values;
  for (int k = 0; k < size.z(); ++k) {
    for (int j = 0; j < size.y(); ++j) {
      for (int i = 0; i < size.x(); ++i) values.push_back(density(i, j, k));
    }
  }
  return Volume::fromDense(size, testLattice(), values, {});
}

// Density falls with the distance [voxel] from the middle; far outside and inside it is constant, so some bricks are.
inline Volume ballField(const Vec3i& size, double radius_voxels) {
  const Vec3 middle = (size.cast<double>().array() - 1) / 2;
  return makeField(size, [=](int i, int j, int k) {
    const double inside = radius_voxels - (Vec3(i, j, k) - middle).norm();
    return static_cast<float>(std::clamp(inside, -3.0, 3.0));
  });
}

// Denormals, zeros of both signs, 1e-30, 1e30, ordinary values and the largest floats, side by side.
inline Volume extremes(const Vec3i& size) {
  std::mt19937 random(11);
  const float scales[] = {1.0F, 1e30F, 1e-30F, 1e-40F, 1e-45F, 0.0F, FLT_MAX};
  return makeField(size, [&](int, int, int) {
    const float unit = static_cast<float>(random()) / 4294967296.0F * 2.0F - 1.0F;
    const auto scale = random() % (std::size(scales) + 1);
    return scale < std::size(scales) ? unit * scales[scale] : std::copysign(FLT_MAX, unit);
  });
}

// The largest floats of both signs and nothing else: sums, differences and products of two overflow.
inline Volume largest(const Vec3i& size) {
  std::mt19937 random(12);
  return makeField(size, [&](int, int, int) { return random() % 2 == 0 ? FLT_MAX : -FLT_MAX; });
}

inline Volume constantField(const Vec3i& size, float density) {
  return makeField(size, [=](int, int, int) { return density; });
}

// The fields that break arithmetic first.
inline std::vector<Volume> extremeFields(const Vec3i& size) {
  std::vector<Volume> volumes;
  volumes.push_back(extremes(size));
  volumes.push_back(largest(size));
  // A body in a far lower fill value, and one step between the lowest and the highest float.
  volumes.push_back(makeField(size, [&](int i, int j, int k) {
    return (Vec3i(i, j, k) - size / 2).squaredNorm() < 25 ? static_cast<float>(i + j) : -FLT_MAX;
  }));
  volumes.push_back(makeField(size, [](int i, int, int) { return i < 9 ? FLT_MAX : -FLT_MAX; }));
  return volumes;
}

// Floats of both signs, the largest, the smallest, and the negative zero, which additions lose.
inline constexpr float kExtremeConstants[] = {FLT_MAX, -FLT_MAX, 1e-45F, -0.0F};

}  // namespace palpate
