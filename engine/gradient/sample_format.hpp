// SPDX-License-Identifier: Apache-2.0
// engine/gradient/sample_format.hpp: how samples (gradient, density) are stored on the GPU: as floats, 16 bytes a
// voxel, or as halves, 8 (shaders/sample_code.layout.h). Windows hold floats either way. Any thread.
//
// A half (IEEE 754 binary16) has 11 significant bits from 2^-14 on, steps of 2^-24 below, and ends at 65504. The
// density is stored as its difference from the isovalue, so it is most precise near the isosurface, where it decides
// contact. Gradient and difference are multiplied by scales s_g and s_d. These are powers of two, chosen so that the
// largest magnitude in the volume becomes at most 2^12. Errors:
//   gradient component   |error| <= 2^-11 |g| + 2^-25 / s_g
//   density              |error| <= 2^-11 |d - isovalue| (1 + 2^-11) + 2^-25 / s_d + 2^-24 |d|
// The last term is the rounding when the isovalue is added again. A density stays on its side of the isovalue unless it
// is nearer to it than 2^-25 / s_d, which is 2^36 times nearer than the farthest density. Where an edit makes a value
// more than 15 times larger than the largest in the volume, the value is clamped there and keeps its sign.
#pragma once

#include <cstdint>

#include "base/vec.hpp"
#include "shaders/sample_code.layout.h"

namespace palpate {

struct SampleFormat {
  bool half = false;
  layout::SampleCode code{0, 1, 1};  // isovalue and scales of halves

  [[nodiscard]] std::size_t bytesAVoxel() const noexcept { return half ? 8 : 16; }
  [[nodiscard]] std::uint32_t bricksASlab() const noexcept {
    return half ? 2 * BRICKS_PER_SAMPLE_SLAB : BRICKS_PER_SAMPLE_SLAB;
  }
  // For kernels that read samples: the inverse scales, which are exact, being powers of two.
  [[nodiscard]] layout::SampleCode readingCode() const noexcept;
};

// Halves for a volume with densities from `lowest` to `highest`. The gradient's scale relies on a bound: no operator's
// gradient exceeds (highest - lowest) over the smallest spacing. (A Gaussian's taps sum to one, up to rounding.)
[[nodiscard]] SampleFormat halfSamples(float isovalue, float lowest, float highest, const Vec3& spacing_m);

// Throws Error(kBadInput) where halves would lose the surface: where half of their smallest step, 2^-25 / s_d, is more
// than 2^-11 of `contrast`, the object's density above the isovalue. One density far from all others can cause that.
void checkHalfSamples(const SampleFormat& format, float lowest, float highest, double contrast);

}  // namespace palpate
