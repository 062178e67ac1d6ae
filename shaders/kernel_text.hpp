// SPDX-License-Identifier: Apache-2.0
// shaders/kernel_text.hpp: the kernels' arithmetic for the CPU, compiled from the same text as the GLSL.
//
// The host uses it to predict a kernel's result (engine/edit), and as a fast version of a kernel. Tests use it as a
// second witness of what the text means: the reference twins (engine/reference) are written apart from it. Compile with
// -ffp-contract=off, as the whole program is.
#pragma once

#include "shaders/draw.layout.h"
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
// The next files use numbers.math.glsl.
#include "shaders/draw_cell.math.glsl"
#include "shaders/edit.math.glsl"
#include "shaders/edit_stamp.math.glsl"
#include "shaders/edit_stencil.math.glsl"
#include "shaders/filter_border.math.glsl"
#include "shaders/filter_convolve.math.glsl"
#include "shaders/filter_distance.math.glsl"
#include "shaders/filter_exp.math.glsl"
// The next files use filter_exp.math.glsl.
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
