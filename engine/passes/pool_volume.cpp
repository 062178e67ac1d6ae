// SPDX-License-Identifier: Apache-2.0
#include "engine/passes/pool_volume.hpp"

#include <algorithm>
#include <array>

#include "base/error.hpp"
#include "engine/bricks/brick_reach.hpp"

namespace palpate {

// The volume that was read is finite. So a density that is not finite comes from the computation, not from the input.
Volume volumeOf(const BrickPool& pool, gpu::Transfer& transfer, const VolumeFacts& facts) {
  const BrickGrid grid = pool.grid();
  try {
    return Volume::fromBricks(pool.size(), pool.lattice(), facts, [&](const Vec3i& brick, float* values) {
      return pool.readBrick(transfer, grid.index(brick), values);
    });
  } catch (const Error& error) {
    if (error.code() != Error::Code::kBadInput) throw;
    throw Error(error.code(), "the field computed from " + facts.source, error.reason(),
                "its densities are too large for what was computed: scale them down");
  }
}

std::vector<float> densitiesOf(const BrickPool& pool, gpu::Transfer& transfer) {
  const BrickGrid grid = pool.grid();
  const Eigen::Matrix<std::size_t, 3, 1> size = pool.size().cast<std::size_t>();
  std::vector<float> densities(size.prod());
  std::array<float, kBrickVoxels> brick{};
  for (std::uint32_t b = 0; b < pool.brickCount(); ++b) {
    if (pool.readBrick(transfer, b, brick.data())) std::fill(brick.begin() + 1, brick.end(), brick[0]);
    const Vec3i first = grid.brick(b) * kBrickSize;
    const Vec3i inside = (pool.size() - first).cwiseMin(kBrickSize);
    for (int k = 0; k < inside.z(); ++k) {
      for (int j = 0; j < inside.y(); ++j) {
        const float* row = brick.data() + (std::ptrdiff_t{k} * kBrickSize + j) * kBrickSize;
        const auto line = static_cast<std::size_t>(first.z() + k) * size.y() + static_cast<std::size_t>(first.y() + j);
        std::copy_n(row, inside.x(), densities.data() + line * size.x() + static_cast<std::size_t>(first.x()));
      }
    }
  }
  return densities;
}

}  // namespace palpate
