// SPDX-License-Identifier: Apache-2.0
// shaders/filter_line.glsl: the common part of filters along one axis. An invocation computes eight results along the
// axis: along i a row of floats, along j or k a column of quads. So each density that it loads serves up to eight
// results.
//
// The kernel includes this after filter.glsl. Before that it defines:
//   uint kAxis, int kReach                 its specialisation constants
//   LINE_ONE, LINE_FOUR                    type of one result, and of the four in a quad
//   LINE_OF(density)                       its value for a loaded density, or for a quad of them
//   LINE_BEGIN(TYPE, found, all)           declares the eight results and its other variables
//   LINE_SHOW(found, all, at, value)       adds the value `at` places after the line's first to all results in reach
//   LINE_END(found, all)                   completes the results in `found`
//   LINE_DENSITY(four)                     the densities of four results
// They are macros, since an array passed to a function would lie in memory.

const int kRing = (kReach + 7) / 8;  // bricks on either side
const uint kLines = kAxis == 0 ? 64 : 16;
const uint kBricks = FILTER_GROUP / kLines;  // in a work group
const int kEnd = int(BRICK_EDGE);

// Results past the last voxel of the domain repeat that of the last voxel.
#define REPEAT_LAST(found, first, last)                \
  [[unroll]] for (int o = 1; o < kEnd; ++o) { \
    if ((first) + o > (last)) found[o] = found[o - 1]; \
  }

void rowAlongX(uvec3 brick, uint row, uint out_quad) {
  LINE_BEGIN(LINE_ONE, found, all)
  if (kEdge == 0) {
    [[unroll]] for (int b = -kRing; b <= kRing; ++b) {
      const BrickPage page = pages[brickIndex(uvec3(int(brick.x) + b, brick.yz))];
      [[unroll]] for (int q = 0; q < 2; ++q) {
        const int first = kEnd * b + 4 * q;
        if (first + 3 < -kReach || first > kEnd - 1 + kReach) continue;
        const LINE_FOUR quad = LINE_OF(pageQuad(page, row * 2 + q));
        [[unroll]] for (int t = 0; t < 4; ++t) { LINE_SHOW(found, all, first + t, quad[t]) }
      }
    }
    LINE_END(found, all)
  } else {
    const uvec3 first = brick * BRICK_EDGE + uvec3(0, row % BRICK_EDGE, row / BRICK_EDGE);
    const int size = int(domainSize().x);
    [[unroll]] for (int at = -kReach; at < kEnd + kReach; ++at) {
      const LINE_ONE value = LINE_OF(densityAt(uvec3(mapped(int(first.x) + at, size), first.yz)));
      LINE_SHOW(found, all, at, value)
    }
    LINE_END(found, all)
    REPEAT_LAST(found, int(first.x), size - 1)
  }
  result[out_quad + row * 2] = LINE_DENSITY(LINE_FOUR(found[0], found[1], found[2], found[3]));
  result[out_quad + row * 2 + 1] = LINE_DENSITY(LINE_FOUR(found[4], found[5], found[6], found[7]));
}

// A column of quads along j or k. `line`: which quad of a row, and which row across the column.
void columnAcross(uvec3 brick, uint line, uint out_quad) {
  const uint quad = line & 1u, across = line >> 1u;
  const uint step = kAxis == 1 ? 2 : 16;  // distance from one quad of the column to the next
  const uint start = quad + across * (kAxis == 1 ? 16 : 2);
  LINE_BEGIN(LINE_FOUR, found, all)
  if (kEdge == 0) {
    // Mesa 22.3 folds a choice between constant vectors by a specialisation constant wrongly, so this computes a
    // number.
    const uint along = kAxis == 1 ? POOL_DOMAIN.bricks_x : POOL_DOMAIN.bricks_x * POOL_DOMAIN.bricks_y;
    [[unroll]] for (int b = -kRing; b <= kRing; ++b) {
      const BrickPage page = pages[uint(int(brickIndex(brick)) + b * int(along))];
      [[unroll]] for (int t = 0; t < kEnd; ++t) {
        const int at = kEnd * b + t;
        if (at < -kReach || at > kEnd - 1 + kReach) continue;
        const LINE_FOUR value = LINE_OF(pageQuad(page, start + step * t));
        LINE_SHOW(found, all, at, value)
      }
    }
    LINE_END(found, all)
  } else {
    const uvec3 in_brick = kAxis == 1 ? uvec3(quad * 4, 0, across) : uvec3(quad * 4, across, 0);
    const uvec3 first = brick * BRICK_EDGE + in_brick;
    const int size = int(domainSize()[kAxis]);
    [[unroll]] for (int at = -kReach; at < kEnd + kReach; ++at) {
      const uint c = mapped(int(first[kAxis]) + at, size);
      const LINE_FOUR value = LINE_OF(quadAt(kAxis == 1 ? uvec3(first.x, c, first.z) : uvec3(first.xy, c)));
      LINE_SHOW(found, all, at, value)
    }
    LINE_END(found, all)
    REPEAT_LAST(found, int(first[kAxis]), size - 1)
  }
  [[unroll]] for (int o = 0; o < kEnd; ++o) result[out_quad + start + step * o] = LINE_DENSITY(found[o]);
}

// Body of the kernel's main(), after its preparations.
void makeLine() {
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
