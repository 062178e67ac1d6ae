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

// As messages have it: "1.5 MiB".
[[nodiscard]] inline std::string inMiB(std::uint64_t bytes) {
  return fmt::format("{:.1f} MiB", static_cast<double>(bytes) / 1048576.0);
}

// The smallest --gpu-memory that holds so much: "16MiB".
[[nodiscard]] inline std::string wholeMiB(std::uint64_t bytes) {
  return fmt::format("{}MiB", (bytes + 1048575) / 1048576);
}

// 0: no limit but the device's.
[[nodiscard]] inline std::shared_ptr<GpuBudget> makeGpuBudget(std::uint64_t limit_bytes = 0) {
  auto budget = std::make_shared<GpuBudget>();
  if (limit_bytes != 0) budget->limit_bytes = limit_bytes;
  return budget;
}

}  // namespace palpate
