// SPDX-License-Identifier: Apache-2.0
// engine/passes/tuning.hpp: what kernels are specialised for on each kind of device, in one table. Results do not
// depend on it, bit for bit; only the time they take does. Any thread; no cost.
#pragma once

#include <cstdint>
#include <span>
#include <string_view>

#include "engine/gpu/gpu.hpp"

namespace palpate {

struct Tuning {
  std::string_view device;  // GpuInfo::tuned_as; the last row has "" and serves all others

  // Rows along k that an invocation of gradient.comp makes: 1, 2, 4 or 8. They share what they read, so a CPU, for
  // which every load is a loop over lanes, wants all eight; a GPU wants 32 invocations to a brick, so that its warps
  // are full, and has caches for what is read again.
  std::uint32_t gradient_run;

  // Bricks of a whole field in one submission: so few that it can be stopped in between and no device gives up on a
  // slow kernel, so many that submitting them costs next to nothing.
  std::uint32_t filter_bricks;
  std::uint32_t gradient_bricks;
};

[[nodiscard]] std::span<const Tuning> tunings() noexcept;
[[nodiscard]] const Tuning& tuningFor(const gpu::GpuInfo& device) noexcept;

}  // namespace palpate
