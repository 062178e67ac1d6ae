// SPDX-License-Identifier: Apache-2.0
// shaders/filter_distance_spread.comp: one pass along one axis. Each voxel takes the nearest surface point, and the
// nearest voxel across, that the voxels within reach on its line know; of equally near ones the first. After one pass
// along each axis, every voxel's point has reached all voxels in a box around it. The nearest voxel across in that box
// has been found too. An invocation is a line of eight voxels along the axis.
#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_control_flow_attributes : require
#include "filter.layout.h"
#include "filter_distance.layout.h"

layout(local_size_x = FILTER_GROUP) in;
layout(push_constant) uniform Push { FilterPush push; };
#define FILTER_RESULT_FLOATS
#include "filter.glsl"
#include "numbers.math.glsl"
#include "filter_distance.math.glsl"

layout(constant_id = FILTER_CONSTANT_OWN) const uint kAxis = 0;
layout(constant_id = FILTER_CONSTANT_OWN + 1) const int kReach = 1;  // at most a brick's edge
const int kEnd = int(BRICK_EDGE);

// Voxel t of line `line` of a brick: its index in floats from the brick's first.
uint inBrick(uint line, uint t) {
  const uint a = line % BRICK_EDGE, b = line / BRICK_EDGE;
  if (kAxis == 0) return line * BRICK_EDGE + t;
  if (kAxis == 1) return (b * BRICK_EDGE + t) * BRICK_EDGE + a;
  return (t * BRICK_EDGE + b) * BRICK_EDGE + a;
}

void main() {
  const uint group = gl_WorkGroupID.y * GROUPS_PER_ROW + gl_WorkGroupID.x;
  if (group >= push.task_count) return;
  const FilterTask task = tasks[push.first_task + group];
  const uvec3 brick = brickOfIndex(task.brick);
  const uint line = gl_LocalInvocationID.x;
  const int along = kAxis == 0 ? 0 : (kAxis == 1 ? 1 : 2);
  const int first = int(brick[along]) * kEnd, last = int(domainSize()[along]) - 1;
  const uint stride = kAxis == 0 ? 1 : (kAxis == 1 ? POOL_DOMAIN.bricks_x : POOL_DOMAIN.bricks_x * POOL_DOMAIN.bricks_y);
  const int axis_1 = kAxis == 0 ? 1 : 0, axis_2 = kAxis == 2 ? 1 : 2;
  const float edge = taps[DISTANCE_EDGE_SQUARE + along];
  const float edge_1 = taps[DISTANCE_EDGE_SQUARE + axis_1], edge_2 = taps[DISTANCE_EDGE_SQUARE + axis_2];

  const float edge_x = taps[DISTANCE_EDGE_SQUARE], edge_y = taps[DISTANCE_EDGE_SQUARE + 1];

  Nearest point[kEnd], across[kEnd];
  bool inside[kEnd];
  const BrickPage own_page = pages[task.brick];
  [[unroll]] for (int o = 0; o < kEnd; ++o) {
    const uint in_brick = inBrick(line, uint(o));
    inside[o] = isInside(floatBitsToUint(pageQuad(own_page, in_brick / 4)[in_brick % 4]));
    point[o] = noPoint();
    across[o] = noAcross();
  }
  [[unroll]] for (int b = -1; b <= 1; ++b) {
    const int there = int(brick[along]) + b;
    const bool exists = there >= 0 && there * kEnd <= last;
    const BrickPage page = pages[exists ? uint(int(task.brick) + b * int(stride)) : task.brick];
    [[unroll]] for (int t = 0; t < kEnd; ++t) {
      const int at = kEnd * b + t;
      if (at < -kReach || at > kEnd - 1 + kReach) continue;
      const uint in_brick = inBrick(line, uint(t));
      const uint word = floatBitsToUint(pageQuad(page, in_brick / 4)[in_brick % 4]);
      const bool known = exists && first + at <= last && word != DISTANCE_NONE;
      const float beside = pointAcross(word, known, axis_1, axis_2, edge_1, edge_2);
      const float offset = float(offsetOf(word, along));
      const float before = acrossBefore(word, along, edge_x, edge_y);
      [[unroll]] for (int o = 0; o < kEnd; ++o) {
        if (at - o < -kReach || at - o > kReach) continue;
        const int shift = (at - o) * DISTANCE_PARTS;
        point[o] = nearerPoint(point[o], word, offset, beside, shift, along, edge);
        across[o] = nearerAcross(across[o], word, known, inside[o], before, squareAlong(float(at - o), edge), at - o,
                                 along);
      }
    }
  }
  uint words[kEnd];
  [[unroll]] for (int o = 0; o < kEnd; ++o) {
    words[o] = wordWith(inside[o], point[o].bits, across[o].bits);
    if (o > 0 && first + o > last) words[o] = words[o - 1];
  }
  const uint out_first = task.slot * (BRICK_QUADS * 4);
  [[unroll]] for (int o = 0; o < kEnd; ++o)
    result_float[out_first + inBrick(line, uint(o))] = uintBitsToFloat(words[o]);
}
