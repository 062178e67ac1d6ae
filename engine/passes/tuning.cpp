// SPDX-License-Identifier: Apache-2.0
#include "engine/passes/tuning.hpp"

#include <algorithm>
#include <iterator>

namespace palpate {
namespace {

// Central gradients of 256^3 voxels took lavapipe 131, 114, 110 and 97 ms of two processors with 1, 2, 4 and 8 rows.
// A submission takes lavapipe 0.1 ms, a brick 3 us for its gradients, 3 us to 2 ms for a step of a filter; a GPU has
// some twenty times the bandwidth. The row for GPUs is not measured but reasoned.
//
// Lavapipe takes 14 ms to make the kernel of two rows from the driver's cache, 33 ms to make that of eight, which saves
// 0.5 us a brick: so two rows are sooner ready for up to some 40,000 bricks.
constexpr Tuning kTunings[] = {
    {.device = "cpu",
     .gradient_run = 8,
     .short_gradient_run = 2,
     .short_gradient_bricks = 32768,
     .filter_bricks = 1024,
     .gradient_bricks = 8192},
    {.device = "",
     .gradient_run = 2,
     .short_gradient_run = 2,
     .short_gradient_bricks = 0,
     .filter_bricks = 16384,
     .gradient_bricks = 65536},
};

}  // namespace

std::span<const Tuning> tunings() noexcept {
  return kTunings;
}

const Tuning& tuningFor(const gpu::GpuInfo& device) noexcept {
  const auto* found = std::find_if(std::begin(kTunings), std::end(kTunings),
                                   [&](const Tuning& row) { return row.device == device.tuned_as; });
  return found != std::end(kTunings) ? *found : *std::prev(std::end(kTunings));
}

}  // namespace palpate
