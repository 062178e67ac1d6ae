// SPDX-License-Identifier: Apache-2.0
// shaders/kernel_text.hpp: the kernels' arithmetic, compiled for the CPU from the same text that GLSL compiles.
//
// It is there for what the host computes of a kernel's result beforehand (engine/edit), for a fast host version, and as
// a second witness of what the text means: the reference twins (engine/reference) are written apart from it. Compile
// with -ffp-contract=off, as the whole program is.
#pragma once

#include "shaders/edit.layout.h"
#include "shaders/filter.layout.h"
#include "shaders/filter_distance.layout.h"
#include "shaders/glsl.hpp"
#include "shaders/layout_types.h"

namespace palpate::kernel_text {
using namespace glsl;  // NOLINT(google-build-using-namespace): the text is GLSL
using layout::EditCommand;
using layout::EditScale;

#define precise
#include "shaders/numbers.math.glsl"
// after the numbers that they use
#include "shaders/edit.math.glsl"
#include "shaders/edit_stamp.math.glsl"
#include "shaders/edit_stencil.math.glsl"
#include "shaders/filter_border.math.glsl"
#include "shaders/filter_convolve.math.glsl"
#include "shaders/filter_distance.math.glsl"
#include "shaders/filter_exp.math.glsl"
// after the exponential that they use
#include "shaders/filter_bilateral.math.glsl"
#include "shaders/filter_diffuse.math.glsl"
#include "shaders/filter_median.math.glsl"
#include "shaders/filter_median_wide.math.glsl"
#include "shaders/filter_rank.math.glsl"
#include "shaders/gradient.math.glsl"
#include "shaders/gradient_sobel.math.glsl"
#include "shaders/sample_code.math.glsl"
#undef precise
#undef MEDIAN_RANK

}  // namespace palpate::kernel_text
