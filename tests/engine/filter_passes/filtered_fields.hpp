// SPDX-License-Identifier: Apache-2.0
// tests/engine/filter_passes/filtered_fields.hpp: fields filtered by the kernels, for tests of filters.
#pragma once

#include <array>
#include <bit>
#include <string_view>
#include <vector>

#include <gtest/gtest.h>

#include "engine/filter_passes/filter_chain.hpp"
#include "engine/passes/pool_volume.hpp"
#include "engine/reference/filter.hpp"
#include "tests/engine/passes/field_bits.hpp"
#include "tests/engine/passes/test_fields.hpp"

namespace palpate {

// Expects that voxels of bricks outside the domain repeat the nearest one inside.
inline void expectBordersRepeated(const BrickPool& pool, gpu::Transfer& transfer) {
  const BrickGrid grid = pool.grid();
  std::array<float, kBrickVoxels> brick{};
  for (std::uint32_t b = 0; b < pool.brickCount(); ++b) {
    if (pool.readBrick(transfer, b, brick.data())) continue;
    const Vec3i first = grid.brick(b) * kBrickSize;
    for (int n = 0; n < kBrickVoxels; ++n) {
      const Vec3i in_brick(n % 8, n / 8 % 8, n / 64);
      const Vec3i inside = (first + in_brick).cwiseMin(pool.size() - Vec3i::Ones()) - first;
      const float value = brick[static_cast<std::size_t>(n)];
      const float nearest = brick[(static_cast<std::size_t>(inside.z()) * 8 + inside.y()) * 8 + inside.x()];
      EXPECT_EQ(std::bit_cast<std::uint32_t>(value), std::bit_cast<std::uint32_t>(nearest))
          << b << ": " << in_brick.transpose();
    }
  }
}

// The filtered field from the GPU, without the voxels of bricks that lie outside the domain. `tuned_as`: a kind of
// device (GpuRequest); empty: that of the device in use.
inline reference::DenseField filteredOnGpu(const Volume& volume, const std::vector<FilterStep>& steps,
                                           std::string_view tuned_as = "") {
  gpu::Gpu gpu{{.tuned_as = std::string(tuned_as)}};
  gpu::Transfer transfer{gpu};
  const BrickPool pool(gpu, transfer, volume);
  FilterChain chain(gpu, transfer, pool, steps);
  chain.run();
  chain.run();  // a second run finds what the first left behind
  expectBordersRepeated(chain.result(), transfer);
  return {volume.size(), volume.lattice(), densitiesOf(chain.result(), transfer)};
}

}  // namespace palpate
