// SPDX-License-Identifier: Apache-2.0
// shaders/filter_extreme_line.comp: highest or lowest density along one axis within reach. The densities within reach
// of all eight results of an invocation are looked through once (the middle part of the windows of van Herk and of Gil
// and Werman).
#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_control_flow_attributes : require
#include "filter.layout.h"

layout(local_size_x = FILTER_GROUP) in;
layout(push_constant) uniform Push { FilterPush push; };
#include "filter.glsl"
#include "filter_extreme.glsl"

layout(constant_id = FILTER_CONSTANT_OWN + 1) const uint kAxis = 0;
layout(constant_id = FILTER_CONSTANT_OWN + 2) const int kReach = 1;

#define LINE_ONE int
#define LINE_FOUR ivec4
#define LINE_OF(density) rankOf(density)
#define LINE_BEGIN(TYPE, found, all)          \
  TYPE found[kEnd], all = TYPE(nothing());    \
  [[unroll]] for (int o = 0; o < kEnd; ++o) found[o] = TYPE(nothing());
#define LINE_SHOW(found, all, at, rank)                                                   \
  if ((at) >= kEnd - 1 - kReach && (at) <= kReach) { \
    all = extreme(all, rank);                                                             \
  } else {                                                                                \
    [[unroll]] for (int o = 0; o < kEnd; ++o) { \
      if (abs((at) - o) <= kReach) found[o] = extreme(found[o], rank);                    \
    }                                                                                     \
  }
#define LINE_END(found, all) \
  [[unroll]] for (int o = 0; o < kEnd; ++o) found[o] = extreme(found[o], all);
#define LINE_DENSITY(four) densityOf(four)
#include "filter_line.glsl"

void main() { makeLine(); }
