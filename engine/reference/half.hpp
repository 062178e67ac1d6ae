// SPDX-License-Identifier: Apache-2.0
// engine/reference/half.hpp: the CPU twin of shaders/sample_code.math.glsl: 16-bit floats (halves) by their definition,
// computed in double. Any thread.
#pragma once

#include <cstdint>

#include "engine/gradient/sample_format.hpp"
#include "servo/window/sample_window.hpp"

namespace palpate::reference {

// The half nearest to a float; of two equally near ones the even one. Clamped to the largest half, 65504. Not for NaN.
[[nodiscard]] std::uint16_t toHalf(float value);
[[nodiscard]] float fromHalf(std::uint16_t half);

// A sample as a window gives it back after it was stored in this format.
[[nodiscard]] Sample stored(const Sample& sample, const SampleFormat& format);

}  // namespace palpate::reference
