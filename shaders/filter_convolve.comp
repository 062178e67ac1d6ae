// SPDX-License-Identifier: Apache-2.0
// shaders/filter_convolve.comp: convolution along one axis.
#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_control_flow_attributes : require
#include "filter.layout.h"

layout(local_size_x = FILTER_GROUP) in;
layout(push_constant) uniform Push { FilterPush push; };
#include "filter.glsl"
#include "numbers.math.glsl"
#include "filter_convolve.math.glsl"

layout(constant_id = FILTER_CONSTANT_OWN) const uint kAxis = 0;
layout(constant_id = FILTER_CONSTANT_OWN + 1) const int kReach = 1;

float tap_of[kReach + 1];

#define LINE_ONE float
#define LINE_FOUR vec4
#define LINE_OF(density) (density)
#define LINE_BEGIN(TYPE, sum, all) TYPE sum[kEnd];
// The sum of a result begins with its first tap.
#define LINE_SHOW(sum, all, at, value)                                                    \
  [[unroll]] for (int o = 0; o < kEnd; ++o) { \
    const int tap = (at) - o;                                                             \
    if (tap == -kReach) sum[o] = firstTap(tap_of[kReach], value);                         \
    if (tap > -kReach && tap <= kReach) sum[o] = addTap(sum[o], tap_of[abs(tap)], value); \
  }
#define LINE_END(sum, all)
#define LINE_DENSITY(four) finite(four)

#include "filter_line.glsl"

void main() {
  [[unroll]] for (int i = 0; i <= kReach; ++i) tap_of[i] = taps[i];
  makeLine();
}
