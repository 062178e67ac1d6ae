// SPDX-License-Identifier: Apache-2.0
// engine/passes/filter_kernels.hpp: which kernel runs a filter step, and how it is specialised: one table. Any thread.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "engine/filter/filter_step.hpp"

namespace palpate {

struct FilterKernel {
  std::string name;                      // shaders/NAME.comp
  std::uint32_t bricks_a_group = 1;      // that a work group works on
  bool has_edge = true;                  // it is built once more for bricks within reach of the border (kEdge)
  std::vector<std::uint32_t> constants;  // its own specialisation constants, from FILTER_CONSTANT_OWN on
};

[[nodiscard]] FilterKernel filterKernel(const FilterStep& step);

// The floats that the kernel is handed, as its own comment says; never none.
[[nodiscard]] std::vector<float> kernelTaps(const FilterStep& step);

}  // namespace palpate
