// SPDX-License-Identifier: Apache-2.0
// Whether memory that was looked at again and again stays what it is.
#pragma once

#include <algorithm>
#include <span>
#include <vector>

#include "base/quantile.hpp"

namespace palpate {

// The last fifth of the looks over the second fifth, less 1: in the first one caches fill. A process that goes to and
// fro between two states, as a service with and without filters, is compared in each of them: by the tenth and the
// ninetieth percentile, of which the one that grew more counts. Not by the extremes, as a look may fall into a save or
// a picture.
[[nodiscard]] inline double growthOf(std::span<const double> looks) {
  const std::size_t fifth = looks.size() / 5;
  if (fifth == 0) return 0;
  const auto of = [&](std::size_t begin, double share) {
    const auto first = looks.begin() + static_cast<std::ptrdiff_t>(begin);
    std::vector<double> sorted(first, first + static_cast<std::ptrdiff_t>(fifth));
    std::ranges::sort(sorted);
    return quantile(sorted, share);
  };
  double most = -1;
  for (const double share : {0.1, 0.9}) {
    const double early = of(fifth, share);
    if (early > 0) most = std::max(most, of(looks.size() - fifth, share) / early - 1);
  }
  return most;
}

}  // namespace palpate
