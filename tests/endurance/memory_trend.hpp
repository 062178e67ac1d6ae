// SPDX-License-Identifier: Apache-2.0
// Whether memory that was looked at again and again stays what it is.
#pragma once

#include <span>
#include <vector>

#include "base/quantile.hpp"

namespace palpate {

// The median of the last fifth of the looks over that of the second fifth, less 1: in the first one caches fill.
// Medians, as a look may fall into a save or a picture.
[[nodiscard]] inline double growthOf(std::span<const double> looks) {
  const std::size_t fifth = looks.size() / 5;
  if (fifth == 0) return 0;
  const auto of = [&](std::size_t begin) {
    return median(std::vector<double>(looks.begin() + static_cast<std::ptrdiff_t>(begin),
                                      looks.begin() + static_cast<std::ptrdiff_t>(begin + fifth)));
  };
  const double early = of(fifth);
  return early > 0 ? of(looks.size() - fifth) / early - 1 : 0;
}

}  // namespace palpate
