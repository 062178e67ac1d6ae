// SPDX-License-Identifier: Apache-2.0
// engine/gradient/sample_format.hpp: how samples (gradient, density) are stored on the GPU: as floats, 16 bytes a
// voxel, or as halves, 8 (shaders/sample_code.layout.h). Windows hold floats either way. Any thread.
//
// A half has 11 bits from 2^-14 on, below that steps of 2^-24, and ends at 65504. The density is stored as
// its distance from the isovalue, so that what decides contact is the truest; gradient and distance are multiplied by
// powers of two, chosen so that the volume's largest becomes at most 2^12. With s the scale:
//   gradient component   |error| <= 2^-11 |g| + 2^-25 / s_g
//   density              |error| <= 2^-11 |d - isovalue| (1 + 2^-11) + 2^-25 / s_d + 2^-24 |d|
// where the last term is the rounding of the sum that gives the float back. A density stays on its side of the
// isovalue, unless it is nearer to it than 2^-25 / s_d: 2^36 times nearer than the farthest. What edits make more than
// 15 times larger than anything in the volume was is cut there; its sign stays.
#pragma once

#include <cstdint>

#include "base/vec.hpp"
#include "shaders/sample_code.layout.h"

namespace palpate {

struct SampleFormat {
  bool half = false;
  layout::SampleCode code{0, 1, 1};  // of halves

  [[nodiscard]] std::size_t bytesAVoxel() const noexcept { return half ? 8 : 16; }
  [[nodiscard]] std::uint32_t bricksASlab() const noexcept {
    return half ? 2 * BRICKS_PER_SAMPLE_SLAB : BRICKS_PER_SAMPLE_SLAB;
  }
  // What kernels that read are handed: the inverse scales, which are powers of two and so exact.
  [[nodiscard]] layout::SampleCode readingCode() const noexcept;
};

// Halves for a volume with densities from `lowest` to `highest`. No operator's gradient exceeds their difference over
// the smallest spacing, and a Gaussian's taps sum to one but for their rounding.
[[nodiscard]] SampleFormat halfSamples(float isovalue, float lowest, float highest, const Vec3& spacing_m);

// Throws Error(kBadInput) where halves would lose the surface: their smallest step, 2^-25 / s_d, is more than 2^-11 of
// the contrast, by which the object lies above the isovalue. A single density far from all others does that.
void checkHalfSamples(const SampleFormat& format, float lowest, float highest, double contrast);

}  // namespace palpate
