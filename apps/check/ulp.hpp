// SPDX-License-Identifier: Apache-2.0
// apps/check/ulp.hpp: the distance between two floats, counted in floats (ULP). Any thread.
#pragma once

#include <cstdint>

namespace palpate {

// 0 for equal bits. +0 and -0 are 1 apart, so that every differing bit shows. NaN and anything else are 2^32 - 1 apart.
[[nodiscard]] std::uint32_t ulpDistance(float a, float b) noexcept;

}  // namespace palpate
