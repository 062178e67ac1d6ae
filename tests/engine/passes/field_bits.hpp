// SPDX-License-Identifier: Apache-2.0
// Comparison of fields, bit by bit.
#pragma once

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdint>

#include "engine/reference/dense_field.hpp"

namespace palpate {

// The number of voxels whose bits differ.
inline std::size_t differing(const reference::DenseField& a, const reference::DenseField& b) {
  std::size_t count = 0;
  for (std::size_t i = 0; i < a.values.size(); ++i) {
    count += std::bit_cast<std::uint32_t>(a.values[i]) != std::bit_cast<std::uint32_t>(b.values[i]) ? 1U : 0U;
  }
  return count;
}

inline std::size_t notFinite(const reference::DenseField& field) {
  return static_cast<std::size_t>(
      std::count_if(field.values.begin(), field.values.end(), [](float value) { return !std::isfinite(value); }));
}

}  // namespace palpate
