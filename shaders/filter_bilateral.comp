// SPDX-License-Identifier: Apache-2.0
// shaders/filter_bilateral.comp: mean of the voxels in a box, weighted by how near they are in place and in density. A
// work group is a brick, an invocation a row of eight voxels. An invocation reads each row of the box once.
#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_control_flow_attributes : require
#include "filter.layout.h"

layout(local_size_x = FILTER_GROUP) in;
layout(push_constant) uniform Push { FilterPush push; };
#include "filter.glsl"
#include "filter_exp.math.glsl"
#include "filter_bilateral.math.glsl"

layout(constant_id = FILTER_CONSTANT_OWN) const int kReachX = 1;
layout(constant_id = FILTER_CONSTANT_OWN + 1) const int kReachY = 1;
layout(constant_id = FILTER_CONSTANT_OWN + 2) const int kReachZ = 1;
const int kEnd = int(BRICK_EDGE);
const int kWide = kEnd + 2 * kReachX;
const uint kTapsX = 1, kTapsY = kTapsX + kReachX + 1, kTapsZ = kTapsY + kReachY + 1;

float window[kWide];  // densities of one row, beginning kReachX before the first result

// The row of the brick that is shifted by y and z from the row `first`.
void readRow(uvec3 brick, ivec3 first, int dy, int dz) {
  if (kEdge == 0) {
    const uint y = uint(first.y + dy), z = uint(first.z + dz);
    [[unroll]] for (int b = -1; b <= 1; ++b) {
      const BrickPage page = pages[brickIndex(uvec3(int(brick.x) + b, y / BRICK_EDGE, z / BRICK_EDGE))];
      [[unroll]] for (int q = 0; q < 2; ++q) {
        const int at = kEnd * b + 4 * q + kReachX;
        if (at + 3 < 0 || at >= kWide) continue;
        const vec4 quad = pageQuad(page, ((z % BRICK_EDGE) * BRICK_EDGE + y % BRICK_EDGE) * 2 + q);
        [[unroll]] for (int t = 0; t < 4; ++t) {
          if (at + t >= 0 && at + t < kWide) window[at + t] = quad[t];
        }
      }
    }
  } else {
    const ivec3 size = ivec3(domainSize());
    const uint y = mapped(first.y + dy, size.y), z = mapped(first.z + dz, size.z);
    [[unroll]] for (int at = 0; at < kWide; ++at) window[at] = densityAt(uvec3(mapped(first.x + at - kReachX, size.x), y, z));
  }
}

void main() {
  const uint group = gl_WorkGroupID.y * GROUPS_PER_ROW + gl_WorkGroupID.x;
  if (group >= push.task_count) return;
  const FilterTask task = tasks[push.first_task + group];
  const uvec3 brick = brickOfIndex(task.brick);
  const uint row = gl_LocalInvocationID.x;
  ivec3 first = ivec3(brick * BRICK_EDGE + uvec3(0, row % BRICK_EDGE, row / BRICK_EDGE));
  // Rows outside the domain repeat the last one inside.
  if (kEdge != 0) first = min(first, ivec3(domainSize()) - 1);

  float centre[kEnd], tap_x[kReachX + 1];
  BilateralSums sums[kEnd];
  [[unroll]] for (int t = 0; t <= kReachX; ++t) tap_x[t] = taps[kTapsX + t];
  readRow(brick, first, 0, 0);
  [[unroll]] for (int o = 0; o < kEnd; ++o) {
    centre[o] = window[o + kReachX];
    sums[o] = bilateralNothing();
  }
  const float inv_range = taps[0];
  for (int dz = -kReachZ; dz <= kReachZ; ++dz) {
    for (int dy = -kReachY; dy <= kReachY; ++dy) {
      readRow(brick, first, dy, dz);
      const float tap_yz = placeTap(taps[kTapsY + abs(dy)], taps[kTapsZ + abs(dz)]);
      [[unroll]] for (int t = 0; t <= 2 * kReachX; ++t) {
        const float tap = placeTap(tap_x[abs(t - kReachX)], tap_yz);
        [[unroll]] for (int o = 0; o < kEnd; ++o) {
          sums[o] = bilateralAdded(sums[o], tap, window[o + t], centre[o], inv_range);
        }
      }
    }
  }
  float mean[kEnd];
  [[unroll]] for (int o = 0; o < kEnd; ++o) mean[o] = bilateralResult(centre[o], sums[o]);
  if (kEdge != 0) {
    const int last = int(domainSize().x) - 1;
    [[unroll]] for (int o = 1; o < kEnd; ++o) {
      if (first.x + o > last) mean[o] = mean[o - 1];
    }
  }
  const uint out_quad = task.slot * BRICK_QUADS + row * 2;
  result[out_quad] = vec4(mean[0], mean[1], mean[2], mean[3]);
  result[out_quad + 1] = vec4(mean[4], mean[5], mean[6], mean[7]);
}
