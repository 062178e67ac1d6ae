// SPDX-License-Identifier: Apache-2.0
// engine/filter_passes/filter_kernels.hpp: which kernel runs a filter step, with which specialisation constants and
// taps. Any thread.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "engine/filter/filter_step.hpp"

namespace palpate {

struct FilterKernel {
  std::string name;                      // shaders/NAME.comp
  std::uint32_t bricks_a_group = 1;      // bricks in each work group
  bool has_edge = true;                  // has a second variant for bricks within reach of the border (kEdge)
  std::vector<std::uint32_t> constants;  // its own specialisation constants, from FILTER_CONSTANT_OWN on
};

[[nodiscard]] FilterKernel filterKernel(const FilterStep& step);

// The floats of the kernel's taps buffer, never empty. A comment in the kernel says which they are.
[[nodiscard]] std::vector<float> kernelTaps(const FilterStep& step);

}  // namespace palpate
