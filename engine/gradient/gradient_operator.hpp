// SPDX-License-Identifier: Apache-2.0
// engine/gradient/gradient_operator.hpp: gradient operators by name: "central", "sobel", "central4", "gaussian:0.8mm"
// (docs/gradients.md compares them). One table; any thread.
//
// Every operator gives the gradient along the lattice's axes [density/m], uses the spacing of each axis, and is exact
// for a linear field. At the volume's border it takes a one-sided difference of first order.
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "engine/filter/filter_spec.hpp"
#include "shaders/gradient.layout.h"

namespace palpate {

// A row of the table of operators.
struct GradientKind {
  std::string_view name;
  std::string_view parameter;                // name of the value behind the colon: "sigma"; empty: none
  std::uint32_t stencil = GRADIENT_CENTRAL;  // GRADIENT_... of the kernel
  int reach = 1;                             // of the stencil, along each axis [voxel]
  std::string_view description;              // for help texts
};
[[nodiscard]] std::span<const GradientKind> gradientKinds() noexcept;

struct GradientOperator {
  GradientKind kind;                  // by default the first row, central
  std::vector<FilterSpec> smoothing;  // applied before the gradient is taken; the sample's density is not smoothed

  GradientOperator();
  explicit GradientOperator(const GradientKind& row) : kind(row) {}
  [[nodiscard]] bool smooths() const noexcept { return !smoothing.empty(); }
};

// The operator that a text such as "gaussian:0.8mm" names. Throws Error(kBadInput) with what is wrong and what may be
// given.
[[nodiscard]] GradientOperator gradientOperator(const std::string& text);

// "central, sobel, central4, gaussian:SIGMA": for help texts.
[[nodiscard]] std::string gradientNames();

}  // namespace palpate
