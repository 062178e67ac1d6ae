// SPDX-License-Identifier: Apache-2.0
// shaders/filter_convolve.comp: convolution along one axis. An invocation makes eight results along it: a row of floats
// along i, a column of quads along j and k, so that each density that it loads serves up to eight results.
#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_control_flow_attributes : require
#include "filter.layout.h"

layout(local_size_x = FILTER_GROUP) in;
layout(push_constant) uniform Push { FilterPush push; };
#include "filter.glsl"
#include "filter_convolve.math.glsl"

layout(constant_id = FILTER_CONSTANT_OWN) const uint kAxis = 0;
layout(constant_id = FILTER_CONSTANT_OWN + 1) const int kReach = 1;
const int kRing = (kReach + 7) / 8;  // bricks on either side
const uint kLines = kAxis == 0 ? 64 : 16;
const uint kBricks = FILTER_GROUP / kLines;  // of a group
const int kEnd = int(BRICK_EDGE);

float tap_of[kReach + 1];

// Adds the density `at` places behind the line's first to the results that it reaches.
#define ADD_TO_RESULTS(sum, at, value)                                                        \
  [[unroll]] for (int o = 0; o < kEnd; ++o) { \
    const int tap = (at) - o;                                                                 \
    if (tap == -kReach) sum[o] = tap_of[kReach] * (value);                                    \
    if (tap > -kReach && tap <= kReach) sum[o] = addTap(sum[o], tap_of[abs(tap)], value);     \
  }

// Results behind the domain's last voxel repeat it.
#define REPEAT_LAST(sum, first, last)                    \
  [[unroll]] for (int o = 1; o < kEnd; ++o) { \
    if ((first) + o > (last)) sum[o] = sum[o - 1];       \
  }

void rowAlongX(uvec3 brick, uint row, uint out_quad) {
  float sum[kEnd];
  if (kEdge == 0) {
    [[unroll]] for (int b = -kRing; b <= kRing; ++b) {
      const BrickPage page = pages[brickIndex(uvec3(int(brick.x) + b, brick.yz))];
      [[unroll]] for (int q = 0; q < 2; ++q) {
        const int first = kEnd * b + 4 * q;
        if (first + 3 < -kReach || first > kEnd - 1 + kReach) continue;
        const vec4 quad = pageQuad(page, row * 2 + q);
        [[unroll]] for (int t = 0; t < 4; ++t) { ADD_TO_RESULTS(sum, first + t, quad[t]) }
      }
    }
  } else {
    const uvec3 first = brick * BRICK_EDGE + uvec3(0, row % BRICK_EDGE, row / BRICK_EDGE);
    const int size = int(domainSize().x);
    [[unroll]] for (int at = -kReach; at < kEnd + kReach; ++at) {
      const float value = densityAt(uvec3(mapped(int(first.x) + at, size), first.yz));
      ADD_TO_RESULTS(sum, at, value)
    }
    REPEAT_LAST(sum, int(first.x), size - 1)
  }
  result[out_quad + row * 2] = vec4(sum[0], sum[1], sum[2], sum[3]);
  result[out_quad + row * 2 + 1] = vec4(sum[4], sum[5], sum[6], sum[7]);
}

// A column of quads along j or k. `line`: which quad of a row, and which row across the column.
void columnAcross(uvec3 brick, uint line, uint out_quad) {
  const uint quad = line & 1u, across = line >> 1u;
  const uint step = kAxis == 1 ? 2 : 16;  // quads from one to the next
  const uint start = quad + across * (kAxis == 1 ? 16 : 2);
  vec4 sum[kEnd];
  if (kEdge == 0) {
    [[unroll]] for (int b = -kRing; b <= kRing; ++b) {
      // No choice between constant vectors by a specialisation constant: Mesa 22.3 folds it wrongly.
      const uint along = kAxis == 1 ? POOL_DOMAIN.bricks_x : POOL_DOMAIN.bricks_x * POOL_DOMAIN.bricks_y;
      const BrickPage page = pages[uint(int(brickIndex(brick)) + b * int(along))];
      [[unroll]] for (int t = 0; t < kEnd; ++t) {
        const int at = kEnd * b + t;
        if (at < -kReach || at > kEnd - 1 + kReach) continue;
        const vec4 value = pageQuad(page, start + step * t);
        ADD_TO_RESULTS(sum, at, value)
      }
    }
  } else {
    const uvec3 in_brick = kAxis == 1 ? uvec3(quad * 4, 0, across) : uvec3(quad * 4, across, 0);
    const uvec3 first = brick * BRICK_EDGE + in_brick;
    const int size = int(domainSize()[kAxis]);
    [[unroll]] for (int at = -kReach; at < kEnd + kReach; ++at) {
      const uint c = mapped(int(first[kAxis]) + at, size);
      const vec4 value = quadAt(kAxis == 1 ? uvec3(first.x, c, first.z) : uvec3(first.xy, c));
      ADD_TO_RESULTS(sum, at, value)
    }
    REPEAT_LAST(sum, int(first[kAxis]), size - 1)
  }
  [[unroll]] for (int o = 0; o < kEnd; ++o) result[out_quad + start + step * o] = sum[o];
}

void main() {
  const uint group = gl_WorkGroupID.y * GROUPS_PER_ROW + gl_WorkGroupID.x;
  const uint task_index = group * kBricks + gl_LocalInvocationID.x / kLines;
  if (task_index >= push.task_count) return;
  [[unroll]] for (int i = 0; i <= kReach; ++i) tap_of[i] = taps[i];
  const FilterTask task = tasks[push.first_task + task_index];
  const uvec3 brick = brickOfIndex(task.brick);
  const uint out_quad = task.slot * BRICK_QUADS;
  const uint line = gl_LocalInvocationID.x % kLines;
  if (kAxis == 0) {
    rowAlongX(brick, line, out_quad);
  } else {
    columnAcross(brick, line, out_quad);
  }
}
