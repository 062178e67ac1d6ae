// SPDX-License-Identifier: Apache-2.0
// engine/passes/gpu_budget.hpp: how much GPU memory the bricks of one engine may take, density and samples together.
// Shared by the stores that grow. Thread: the Gpu's.
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

// 0: no limit but the device's.
[[nodiscard]] inline std::shared_ptr<GpuBudget> makeGpuBudget(std::uint64_t limit_bytes = 0) {
  auto budget = std::make_shared<GpuBudget>();
  if (limit_bytes != 0) budget->limit_bytes = limit_bytes;
  return budget;
}

}  // namespace palpate
