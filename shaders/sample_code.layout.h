// SPDX-License-Identifier: Apache-2.0
// shaders/sample_code.layout.h: how samples (gradient, density) are stored. As floats they take one uvec4 a voxel, as
// halves one uvec4 for two voxels.
//
// A half keeps 11 bits, from 2^-14 to 65504. So the density is stored as its difference from the isovalue. Gradient and
// density are scaled by powers of two, which costs no bits (engine/gradient/sample_format.hpp).
#ifndef PALPATE_SAMPLE_CODE_LAYOUT_H
#define PALPATE_SAMPLE_CODE_LAYOUT_H
#include "brick_pool.layout.h"

PALPATE_LAYOUT_BEGIN

// How halves are scaled; unused for floats.
struct SampleCode {
  float zero;            // the density that is stored as 0 [density]
  float density_scale;   // stored density = (density - zero) * this; readers get the inverse
  float gradient_scale;  // stored gradient = gradient * this; readers get the inverse
};

PALPATE_LAYOUT_CHECK(SampleCode, 12)

PALPATE_LAYOUT_END
#endif
