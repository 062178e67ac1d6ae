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
#include "numbers.math.glsl"
#include "edit.math.glsl"
#include "edit_stencil.math.glsl"

Row rowAt(uint brick_x, uint y, uint z) {
  const uint brick = brickIndex(uvec3(brick_x, y / BRICK_EDGE, z / BRICK_EDGE));
  return pageRow(pages[brick], y % BRICK_EDGE, z % BRICK_EDGE);
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
  const ivec4 x = ivec4(int(first.x)) + ivec4(0, 1, 2, 3);
  const float py = placeAlong(int(y), c.origin_y, push.scale.h_y);
  const float pz = placeAlong(int(z), c.origin_z, push.scale.h_z);
  Row result;
  result.low = editedAmong(kKind, c, push.scale, placesAlong(x, c.origin_x, push.scale.h_x), py, pz, centre.low,
                           EditNeighbours(low_x0, low_x1, y0.low, y1.low, z0.low, z1.low));
  result.high = editedAmong(kKind, c, push.scale, placesAlong(x + 4, c.origin_x, push.scale.h_x), py, pz, centre.high,
                            EditNeighbours(high_x0, high_x1, y0.high, y1.high, z0.high, z1.high));
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
