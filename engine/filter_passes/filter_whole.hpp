// SPDX-License-Identifier: Apache-2.0
// engine/filter_passes/filter_whole.hpp: runs a chain of filter steps over every brick of a field. Thread: the Gpu's.
//
// Its scratch pools are freed at the end of the run, since each may be as large as the field. Edits, which reach only a
// few bricks, have scratch pools of their own (filter_region.hpp).
#pragma once

#include <functional>
#include <span>

#include "engine/filter_passes/filter_dispatch.hpp"
#include "engine/filter_passes/filter_route.hpp"
#include "engine/gpu/transfer.hpp"
#include "engine/passes/brick_pool.hpp"

namespace palpate {

// Blocks. `progress`, if given, gets the fraction done after every submission (submission_size.hpp). It may throw to
// cancel; the content of `result` is then undefined. Throws Error(kOutOfMemory).
void filterWhole(gpu::Gpu& gpu, gpu::Transfer& transfer, FilterDispatch& steps, std::span<const FilterRoute> routes,
                 const BrickPool& source, BrickPool& result, const std::function<void(double)>& progress);

}  // namespace palpate
