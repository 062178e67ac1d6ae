// SPDX-License-Identifier: Apache-2.0
// engine/passes/pool_volume.hpp: copies the content of a brick pool to the CPU. Thread: the Gpu's. Cost: a copy of the
// stored bricks and, where the device's memory is not mapped, a transfer for each.
#pragma once

#include <vector>

#include "engine/field/volume.hpp"
#include "engine/gpu/transfer.hpp"
#include "engine/passes/brick_pool.hpp"

namespace palpate {

// Throws Error(kBadInput) where a density is not a finite number.
[[nodiscard]] Volume volumeOf(const BrickPool& pool, gpu::Transfer& transfer, const VolumeFacts& facts);

// The domain's densities, i fastest; NaN and infinity are allowed.
[[nodiscard]] std::vector<float> densitiesOf(const BrickPool& pool, gpu::Transfer& transfer);

}  // namespace palpate
