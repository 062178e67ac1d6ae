// SPDX-License-Identifier: Apache-2.0
// engine/gradient/gradient_operator.hpp: ways to take a gradient, as a person names them: "central", "sobel",
// "central4", "gaussian:0.8mm" (docs/gradients.md compares them). One table; any thread.
//
// All give the gradient along the lattice's axes [density/m] with the spacing of each axis, are exact for a linear
// field, and end at the border with a one-sided difference of first order.
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "engine/filter/filter_spec.hpp"
#include "shaders/gradient.layout.h"

namespace palpate {

// A row of the table.
struct GradientWords {
  std::string_view name;
  std::string_view takes;                    // "sigma", with its unit behind a colon; empty: nothing
  std::uint32_t stencil = GRADIENT_CENTRAL;  // what the kernel computes
  int reach = 1;                             // of the stencil, along each axis [voxel]
  std::string_view what;
};
[[nodiscard]] std::span<const GradientWords> gradientTable() noexcept;

struct GradientOperator {
  GradientWords words;                // of the table's first row if nothing is said: central
  std::vector<FilterSpec> smoothing;  // of the field whose gradient is taken; the sample's density stays as it is

  GradientOperator();
  explicit GradientOperator(const GradientWords& row) : words(row) {}
  [[nodiscard]] bool smooths() const noexcept { return !smoothing.empty(); }
};

// Throws Error(kBadInput) with what is wrong and what may be given.
[[nodiscard]] GradientOperator gradientOperator(const std::string& text);

// "central, sobel, central4, gaussian:SIGMA": for help texts.
[[nodiscard]] std::string gradientNames();

}  // namespace palpate
