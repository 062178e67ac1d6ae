// SPDX-License-Identifier: Apache-2.0
// shaders/edit_stencil.comp: runs one edit command that reads a voxel's neighbours (smooth, inflate, deflate) over
// listed bricks. It leaves the pool as it is and writes the changed bricks aside, so no voxel sees another's new
// density.
#version 460
#extension GL_GOOGLE_include_directive : require
#include "edit.layout.h"

layout(local_size_x = BRICK_ROWS) in;
layout(constant_id = 1) const uint kKind = EDIT_SMOOTH;
layout(push_constant) uniform Push { EditPush push; };
#define POOL_DOMAIN push.domain
#include "brick_pool.glsl"

layout(std430, binding = STENCIL_BINDING_TASKS) readonly buffer Tasks { EditTask tasks[]; };
layout(std430, binding = STENCIL_BINDING_COMMANDS) readonly buffer Commands { EditCommand commands[]; };
layout(std430, binding = STENCIL_BINDING_ASIDE) writeonly buffer Aside { vec4 aside[]; };
#include "edit.math.glsl"

Row rowAt(uint brick_x, uint y, uint z) {
  const uint brick = brickIndex(uvec3(brick_x, y / BRICK_EDGE, z / BRICK_EDGE));
  return pageRow(pages[brick], y % BRICK_EDGE, z % BRICK_EDGE);
}

// What an axis adds: both differences to the neighbours, times their share. Densities near the largest float may
// overflow, on two axes with different signs. So each sum is kept finite, and the axes add up to a number.
vec4 blur(vec4 f, vec4 before, vec4 after, float share) {
  precise vec4 sum = finite((before - f) + (after - f)) * share;
  return sum;
}

// Square of the steepest rise (sign +1) or fall (sign -1) to a neighbour along an axis: the upwind difference of a
// moving surface after Osher and Sethian (1988), which makes no new extrema. `highest`: the highest of sign times
// density among the neighbours so far.
vec4 upwindSquare(vec4 f, vec4 before, vec4 after, float sign, float inv_h, inout vec4 highest) {
  const vec4 top = greater(sign * before, sign * after);
  highest = greater(highest, top);
  precise vec4 steep = greater(top - sign * f, vec4(0)) * inv_h;
  precise vec4 square = steep * steep;
  return square;
}

vec4 smoothed(vec4 f, vec4 x0, vec4 x1, vec4 y0, vec4 y1, vec4 z0, vec4 z1, vec4 amount) {
  precise vec4 sum = (blur(f, x0, x1, push.blur_x) + blur(f, y0, y1, push.blur_y)) + blur(f, z0, z1, push.blur_z);
  precise vec4 moved = finite(f + amount * sum);
  return moved;
}

// Moves the surface by `way` [m]. In this scheme no density passes its highest neighbour; the last line keeps that true
// where squares overflow.
vec4 inflated(vec4 f, vec4 x0, vec4 x1, vec4 y0, vec4 y1, vec4 z0, vec4 z1, vec4 way, float sign) {
  vec4 highest = sign * f;
  const vec4 x = upwindSquare(f, x0, x1, sign, push.inv_h_x, highest);
  const vec4 y = upwindSquare(f, y0, y1, sign, push.inv_h_y, highest);
  const vec4 z = upwindSquare(f, z0, z1, sign, push.inv_h_z, highest);
  precise vec4 square = (x + y) + z;
  precise vec4 moved = f + (way * sign) * lesser(sqrt(square), vec4(kLargest));
  return mix(moved, sign * highest, lessThan(highest, sign * moved));
}

vec4 edited(EditCommand c, vec4 px, float py, float pz, vec4 f, vec4 x0, vec4 x1, vec4 y0, vec4 y1, vec4 z0, vec4 z1) {
  const vec4 distance = strokeDistance(c, px, py, pz);
  const bvec4 reached = lessThanEqual(distance, vec4(c.reach));
  const vec4 amount = amountAt(c, distance);
  vec4 moved;
  if (kKind == EDIT_SMOOTH) {
    moved = smoothed(f, x0, x1, y0, y1, z0, z1, amount);
  } else {
    precise vec4 way = amount * c.value;
    moved = inflated(f, x0, x1, y0, y1, z0, z1, way, kKind == EDIT_INFLATE ? 1.0 : -1.0);
  }
  return mix(f, moved, bvec4(uvec4(reached) & uvec4(greaterThan(amount, vec4(0)))));
}

float element(Row row, uint i) { return i < 4 ? row.low[i] : row.high[i - 4]; }

void main() {
  const uint index = gl_WorkGroupID.y * GROUPS_PER_ROW + gl_WorkGroupID.x;
  if (index >= push.task_count) return;
  const EditTask task = tasks[push.first_task + index];
  const uvec3 brick = brickOfIndex(task.brick);
  const uint row_index = gl_LocalInvocationID.x;
  const uvec3 last = domainSize() - 1;
  const uvec3 first = min(brick * BRICK_EDGE + uvec3(0, row_index % BRICK_EDGE, row_index / BRICK_EDGE), last);
  const uint y = first.y, z = first.z;

  const Row centre = rowAt(brick.x, y, z);
  const Row y0 = rowAt(brick.x, y == 0 ? 0 : y - 1, z), y1 = rowAt(brick.x, min(y + 1, last.y), z);
  const Row z0 = rowAt(brick.x, y, z == 0 ? 0 : z - 1), z1 = rowAt(brick.x, y, min(z + 1, last.z));
  const float before = brick.x == 0 ? centre.low.x : rowAt(brick.x - 1, y, z).high.w;
  const float after = first.x + BRICK_EDGE <= last.x ? rowAt(brick.x + 1, y, z).low.x : centre.high.w;
  const vec4 low_x0 = vec4(before, centre.low.xyz), low_x1 = vec4(centre.low.yzw, centre.high.x);
  const vec4 high_x0 = vec4(centre.low.w, centre.high.xyz), high_x1 = vec4(centre.high.yzw, after);

  const EditCommand c = commands[push.first_command];
  const ivec4 x = ivec4(int(first.x)) - c.origin_x + ivec4(0, 1, 2, 3);
  precise vec4 px_low = vec4(x) * push.h_x;
  precise vec4 px_high = vec4(x + 4) * push.h_x;
  precise float py = float(int(y) - c.origin_y) * push.h_y;
  precise float pz = float(int(z) - c.origin_z) * push.h_z;
  Row result;
  result.low = edited(c, px_low, py, pz, centre.low, low_x0, low_x1, y0.low, y1.low, z0.low, z1.low);
  result.high = edited(c, px_high, py, pz, centre.high, high_x0, high_x1, y0.high, y1.high, z0.high, z1.high);
  if (first.x + BRICK_EDGE - 1 > last.x) {  // voxels past the domain repeat the last one inside
    const uint inside = last.x - first.x;
    const vec4 repeated = vec4(element(result, inside));
    result.low = mix(result.low, repeated, greaterThan(uvec4(0, 1, 2, 3), uvec4(inside)));
    result.high = mix(result.high, repeated, greaterThan(uvec4(4, 5, 6, 7), uvec4(inside)));
  }
  const uint at = index * BRICK_QUADS + row_index * 2;
  aside[at] = result.low;
  aside[at + 1] = result.high;
}
