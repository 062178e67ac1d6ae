// SPDX-License-Identifier: Apache-2.0
#include "apps/check/ulp.hpp"

#include <bit>
#include <cmath>
#include <limits>

namespace palpate {
namespace {

// Maps the floats in their order to integers in theirs: negative ones count down from 0x7fffffff.
std::uint32_t order(float value) noexcept {
  constexpr std::uint32_t kSign = 0x80000000U;
  const auto bits = std::bit_cast<std::uint32_t>(value);
  return (bits & kSign) != 0 ? ~bits : bits | kSign;
}

}  // namespace

std::uint32_t ulpDistance(float a, float b) noexcept {
  if (std::bit_cast<std::uint32_t>(a) == std::bit_cast<std::uint32_t>(b)) return 0;
  if (std::isnan(a) || std::isnan(b)) return std::numeric_limits<std::uint32_t>::max();
  return order(a) > order(b) ? order(a) - order(b) : order(b) - order(a);
}

}  // namespace palpate
