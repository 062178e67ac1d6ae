// SPDX-License-Identifier: Apache-2.0
// engine/passes/filter_whole.hpp: a chain of filter steps over every brick of a field. Thread: the Gpu's.
//
// Scratch pools are made for the run and freed with it: each is as large as the field, and would be kept for edits that
// reach a few bricks (filter_region.hpp has pools of its own for those).
#pragma once

#include <functional>
#include <span>

#include "engine/gpu/transfer.hpp"
#include "engine/passes/brick_pool.hpp"
#include "engine/passes/filter_dispatch.hpp"
#include "engine/passes/filter_route.hpp"

namespace palpate {

// Blocks. `progress`, if there is one, gets the fraction done, as many bricks apart as the device's tuning says, and
// may throw to cancel: `result` then holds nothing of use. Throws Error(kOutOfMemory).
void filterWhole(gpu::Gpu& gpu, gpu::Transfer& transfer, FilterDispatch& steps, std::span<const FilterRoute> routes,
                 const BrickPool& source, BrickPool& result, const std::function<void(double)>& progress);

}  // namespace palpate
