// SPDX-License-Identifier: Apache-2.0
// engine/passes/tuning.hpp: how kernels are tuned for each type of device, in one table. Only run time depends on it;
// results are the same, bit for bit. Any thread; no cost.
#pragma once

#include <cstdint>
#include <span>
#include <string_view>

#include "engine/gpu/gpu.hpp"

namespace palpate {

struct Tuning {
  std::string_view device;  // GpuInfo::tuned_as; the last row has "" and serves all other devices

  // Rows along k that one invocation of gradient.comp computes: 1, 2, 4 or 8. The rows of an invocation share what they
  // read. On a CPU every load is a loop over lanes, so eight rows are best. A GPU needs 32 invocations for each brick
  // to fill its warps, and its caches serve repeated reads.
  std::uint32_t gradient_run;
  // The same where at most so many bricks are computed, and once: a driver has less to compile then.
  std::uint32_t short_gradient_run;
  std::uint32_t short_gradient_bricks;

  // Most bricks in one submission when a whole field is computed. A filter's submission has fewer bricks if it would
  // take more than a tenth of a second.
  std::uint32_t filter_bricks;
  std::uint32_t gradient_bricks;
};

[[nodiscard]] std::span<const Tuning> tunings() noexcept;
[[nodiscard]] const Tuning& tuningFor(const gpu::GpuInfo& device) noexcept;

}  // namespace palpate
