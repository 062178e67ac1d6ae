// SPDX-License-Identifier: Apache-2.0
// shaders/filter_extreme.glsl: the higher or the lower of two ranks, as the filter step asks. Include after
// filter.glsl.
#include "filter_rank.math.glsl"

layout(constant_id = FILTER_CONSTANT_OWN) const uint kExtreme = EXTREME_HIGHEST;

int nothing() { return noExtreme(kExtreme); }
int extreme(int a, int b) { return extremeOf(kExtreme, a, b); }
ivec4 extreme(ivec4 a, ivec4 b) { return extremeOf(kExtreme, a, b); }
