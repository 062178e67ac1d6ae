// SPDX-License-Identifier: Apache-2.0
// engine/passes/gpu_budget.hpp: the GPU memory that the densities and samples of one engine may take together. Shared
// by all its pools and stores. Thread: the Gpu's.
#pragma once

#include <cstdint>
#include <limits>
#include <memory>
#include <string>

#include <fmt/format.h>

namespace palpate {

struct GpuBudget {
  std::uint64_t limit_bytes = std::numeric_limits<std::uint64_t>::max();
  std::uint64_t used_bytes = 0;

  [[nodiscard]] std::uint64_t leftBytes() const noexcept {
    return used_bytes < limit_bytes ? limit_bytes - used_bytes : 0;
  }
};

// `limit_bytes` 0: the device's memory is the only limit.
[[nodiscard]] inline std::shared_ptr<GpuBudget> makeGpuBudget(std::uint64_t limit_bytes = 0) {
  auto budget = std::make_shared<GpuBudget>();
  if (limit_bytes != 0) budget->limit_bytes = limit_bytes;
  return budget;
}

}  // namespace palpate
