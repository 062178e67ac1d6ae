// SPDX-License-Identifier: Apache-2.0
// shaders/filter_extreme_line.comp: highest or lowest density along one axis within reach. An invocation makes eight
// results along it, as filter_convolve.comp does: a row of floats along i, a column of quads along j and k. What stands
// within reach of all eight is looked through once (the middle part of van Herk's and of Gil and Werman's windows).
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
const int kRing = (kReach + 7) / 8;  // bricks on either side
const uint kLines = kAxis == 0 ? 64 : 16;
const uint kBricks = FILTER_GROUP / kLines;  // of a group
const int kEnd = int(BRICK_EDGE);

// Shows the rank `at` places behind the line's first to the results that it reaches.
#define SHOW_TO_RESULTS(found, all, at, rank)                                             \
  if ((at) >= kEnd - 1 - kReach && (at) <= kReach) { \
    all = extreme(all, rank);                                                             \
  } else {                                                                                \
    [[unroll]] for (int o = 0; o < kEnd; ++o) { \
      if (abs((at) - o) <= kReach) found[o] = extreme(found[o], rank);                    \
    }                                                                                     \
  }

// Results behind the domain's last voxel repeat it.
#define REPEAT_LAST(found, first, last)                      \
  [[unroll]] for (int o = 1; o < kEnd; ++o) { \
    if ((first) + o > (last)) found[o] = found[o - 1];       \
  }

void rowAlongX(uvec3 brick, uint row, uint out_quad) {
  int found[kEnd], all = kNothing;
  [[unroll]] for (int o = 0; o < kEnd; ++o) found[o] = kNothing;
  if (kEdge == 0) {
    [[unroll]] for (int b = -kRing; b <= kRing; ++b) {
      const BrickPage page = pages[brickIndex(uvec3(int(brick.x) + b, brick.yz))];
      [[unroll]] for (int q = 0; q < 2; ++q) {
        const int first = kEnd * b + 4 * q;
        if (first + 3 < -kReach || first > kEnd - 1 + kReach) continue;
        const ivec4 quad = rankOf(pageQuad(page, row * 2 + q));
        [[unroll]] for (int t = 0; t < 4; ++t) { SHOW_TO_RESULTS(found, all, first + t, quad[t]) }
      }
    }
  } else {
    const uvec3 first = brick * BRICK_EDGE + uvec3(0, row % BRICK_EDGE, row / BRICK_EDGE);
    const int size = int(domainSize().x);
    [[unroll]] for (int at = -kReach; at < kEnd + kReach; ++at) {
      const int rank = rankOf(densityAt(uvec3(mapped(int(first.x) + at, size), first.yz)));
      SHOW_TO_RESULTS(found, all, at, rank)
    }
  }
  [[unroll]] for (int o = 0; o < kEnd; ++o) found[o] = extreme(found[o], all);
  if (kEdge != 0) { REPEAT_LAST(found, int(brick.x * BRICK_EDGE), int(domainSize().x) - 1) }
  result[out_quad + row * 2] = densityOf(ivec4(found[0], found[1], found[2], found[3]));
  result[out_quad + row * 2 + 1] = densityOf(ivec4(found[4], found[5], found[6], found[7]));
}

// A column of quads along j or k. `line`: which quad of a row, and which row across the column.
void columnAcross(uvec3 brick, uint line, uint out_quad) {
  const uint quad = line & 1u, across = line >> 1u;
  const uint step = kAxis == 1 ? 2 : 16;  // quads from one to the next
  const uint start = quad + across * (kAxis == 1 ? 16 : 2);
  ivec4 found[kEnd], all = ivec4(kNothing);
  [[unroll]] for (int o = 0; o < kEnd; ++o) found[o] = ivec4(kNothing);
  const uvec3 in_brick = kAxis == 1 ? uvec3(quad * 4, 0, across) : uvec3(quad * 4, across, 0);
  const uvec3 first = brick * BRICK_EDGE + in_brick;
  const int size = int(kAxis == 1 ? domainSize().y : domainSize().z);
  const int first_along = int(kAxis == 1 ? first.y : first.z);
  if (kEdge == 0) {
    [[unroll]] for (int b = -kRing; b <= kRing; ++b) {
      const uint along = kAxis == 1 ? POOL_DOMAIN.bricks_x : POOL_DOMAIN.bricks_x * POOL_DOMAIN.bricks_y;
      const BrickPage page = pages[uint(int(brickIndex(brick)) + b * int(along))];
      [[unroll]] for (int t = 0; t < kEnd; ++t) {
        const int at = kEnd * b + t;
        if (at < -kReach || at > kEnd - 1 + kReach) continue;
        const ivec4 rank = rankOf(pageQuad(page, start + step * t));
        SHOW_TO_RESULTS(found, all, at, rank)
      }
    }
  } else {
    [[unroll]] for (int at = -kReach; at < kEnd + kReach; ++at) {
      const uint c = mapped(first_along + at, size);
      const ivec4 rank = rankOf(quadAt(uvec3(first.x, kAxis == 1 ? c : first.y, kAxis == 1 ? first.z : c)));
      SHOW_TO_RESULTS(found, all, at, rank)
    }
  }
  [[unroll]] for (int o = 0; o < kEnd; ++o) found[o] = extreme(found[o], all);
  if (kEdge != 0) { REPEAT_LAST(found, first_along, size - 1) }
  [[unroll]] for (int o = 0; o < kEnd; ++o) result[out_quad + start + step * o] = densityOf(found[o]);
}

void main() {
  const uint group = gl_WorkGroupID.y * GROUPS_PER_ROW + gl_WorkGroupID.x;
  const uint task_index = group * kBricks + gl_LocalInvocationID.x / kLines;
  if (task_index >= push.task_count) return;
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
