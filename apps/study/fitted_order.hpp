// SPDX-License-Identifier: Apache-2.0
// apps/study/fitted_order.hpp: the order of convergence that measured errors show: p in error = C h^p. Any thread; no
// cost.
#pragma once

#include <span>

namespace palpate {

struct SizeAndError {
  double size = 0, error = 0;  // both above 0
};

// The slope of log(error) over log(size) by least squares. NaN with less than two different sizes, or if a figure is
// not finite or not above 0.
[[nodiscard]] double fittedOrder(std::span<const SizeAndError> points);

}  // namespace palpate
