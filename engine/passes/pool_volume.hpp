// SPDX-License-Identifier: Apache-2.0
// engine/passes/pool_volume.hpp: what a brick pool holds, brought to the CPU. Thread: the Gpu's. Cost: a copy of
// the bricks that are stored, and, where the device's memory is not mapped, a transfer each.
#pragma once

#include <vector>

#include "engine/gpu/transfer.hpp"
#include "engine/passes/brick_pool.hpp"
#include "engine/volume/volume.hpp"

namespace palpate {

// Throws Error(kBadInput) where a density is not a finite number.
[[nodiscard]] Volume volumeOf(const BrickPool& pool, gpu::Transfer& transfer, const VolumeFacts& facts);

// The domain's densities, i fastest, whatever they are.
[[nodiscard]] std::vector<float> densitiesOf(const BrickPool& pool, gpu::Transfer& transfer);

}  // namespace palpate
