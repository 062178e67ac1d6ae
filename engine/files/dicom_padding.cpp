// SPDX-License-Identifier: Apache-2.0
#include "engine/files/dicom_padding.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include <fmt/format.h>

#include "base/error.hpp"
#include "engine/files/dicom_values.hpp"

namespace palpate {

SettledPadding settlePadding(std::vector<float>& densities, const std::vector<bool>& padding, bool may_keep,
                             const std::string& source) {
  SettledPadding settled;
  settled.padded = static_cast<std::size_t>(std::count(padding.begin(), padding.end(), true));
  if (settled.padded == 0) return settled;
  if (settled.padded == densities.size()) {
    refuse(source, fmt::format("all of its {} pixels are padding (PixelPaddingValue)", densities.size()),
           "give another series");
  }
  float lowest = std::numeric_limits<float>::infinity();
  float highest = -lowest;
  for (std::size_t n = 0; n < densities.size(); ++n) {
    if (padding[n]) continue;
    if (densities[n] < lowest) lowest = densities[n];
    if (densities[n] > highest) highest = densities[n];
  }
  const bool one_density = lowest >= highest;
  constexpr float kSpanOfPictures = 256;
  const float span = highest - lowest;
  const float least = span >= kSpanOfPictures ? lowest - span : -std::numeric_limits<float>::max();
  for (std::size_t n = 0; n < densities.size(); ++n) {
    if (!padding[n]) continue;
    if (may_keep && std::isfinite(densities[n]) && (one_density || (densities[n] <= lowest && densities[n] >= least))) {
      ++settled.kept;
    } else {
      densities[n] = noValue();
    }
  }
  return settled;
}

}  // namespace palpate
