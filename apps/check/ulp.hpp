// SPDX-License-Identifier: Apache-2.0
// apps/check/ulp.hpp: how many floats lie between two floats. Any thread.
#pragma once

#include <cstdint>

namespace palpate {

// 0 for equal bits; +0 and -0 are 1 apart, so that no differing bit goes unseen; NaN against anything else is 2^32 - 1.
[[nodiscard]] std::uint32_t ulpDistance(float a, float b) noexcept;

}  // namespace palpate
