// SPDX-License-Identifier: Apache-2.0
// Comparison of samples, bit by bit.
#pragma once

#include <array>
#include <bit>
#include <cstdint>

#include "servo/window/sample_window.hpp"

namespace palpate {

// Compares bits, not values: -0 differs from +0.
inline bool sameBits(const Sample& a, const Sample& b) {
  using Bits = std::array<std::uint32_t, 4>;
  return std::bit_cast<Bits>(a) == std::bit_cast<Bits>(b);
}

}  // namespace palpate
