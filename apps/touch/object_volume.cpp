// SPDX-License-Identifier: Apache-2.0
#include "apps/touch/object_volume.hpp"

#include <array>
#include <cstdint>

#include "engine/bricks/brick_grid.hpp"

namespace palpate {
namespace {

// Of the brick's voxels that lie in the domain.
std::int64_t voxelsAbove(const std::array<float, kBrickVoxels>& values, const Vec3i& inside, float isovalue) {
  std::int64_t count = 0;
  for (int k = 0; k < inside.z(); ++k) {
    for (int j = 0; j < inside.y(); ++j) {
      const float* row = values.data() + (std::ptrdiff_t{k} * kBrickSize + j) * kBrickSize;
      for (int i = 0; i < inside.x(); ++i) count += row[i] > isovalue ? 1 : 0;
    }
  }
  return count;
}

}  // namespace

double objectVolume_m3(const Volume& volume, double isovalue) {
  const auto threshold = static_cast<float>(isovalue);  // as kernels and servo compare
  std::array<float, kBrickVoxels> values{};
  std::int64_t above = 0;
  const BrickGrid grid{volume.size(), volume.lattice().spacing_m};
  grid.forEach([&](const Vec3i& brick) {
    const Vec3i inside = (volume.size() - kBrickSize * brick).cwiseMin(Vec3i::Constant(kBrickSize));
    const bool is_constant = volume.readBrick(brick, values.data());
    if (is_constant) {
      above += values[0] > threshold ? std::int64_t{inside.prod()} : 0;
    } else {
      above += voxelsAbove(values, inside, threshold);
    }
  });
  return static_cast<double>(above) * volume.lattice().spacing_m.prod();
}

}  // namespace palpate
