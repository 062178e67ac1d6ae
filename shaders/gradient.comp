// SPDX-License-Identifier: Apache-2.0
// shaders/gradient.comp: plane-ready samples (gradient, density) of listed bricks. A work group is a brick, an invocation a
// row of eight voxels along i: ten vec4 loads serve eight gradients, with no shared memory (which lavapipe punishes).
#version 460
#extension GL_GOOGLE_include_directive : require
#include "gradient.layout.h"

layout(local_size_x = BRICK_ROWS) in;
layout(push_constant) uniform Push { GradientPush push; };
#define POOL_DOMAIN push.domain
#include "brick_pool.glsl"
#include "gradient.math.glsl"

layout(std430, binding = GRADIENT_BINDING_TASKS) readonly buffer Tasks { BrickTask tasks[]; };
layout(std430, binding = GRADIENT_BINDING_SAMPLES) writeonly buffer Samples { vec4 samples[]; };
layout(std430, binding = GRADIENT_BINDING_BOUNDS) readonly buffer Bounds { BrickBounds bounds[]; };
#define ACTIVE_ISOVALUE push.isovalue
#include "active_brick.glsl"

// The row at voxel coordinates (y, z) of brick column `brick_x`.
Row rowAt(uint brick_x, uint y, uint z) {
  const uint brick = brickIndex(uvec3(brick_x, y / BRICK_EDGE, z / BRICK_EDGE));
  return pageRow(pages[brick], y % BRICK_EDGE, z % BRICK_EDGE);
}

float element(Row row, uint i) { return i < 4 ? row.low[i] : row.high[i - 4]; }

void main() {
  const uint task_index = gl_WorkGroupID.y * GROUPS_PER_ROW + gl_WorkGroupID.x;
  if (task_index >= push.task_count) return;
  const BrickTask task = tasks[push.first_task + task_index];
  const uvec3 brick = brickOfIndex(task.brick);
  if ((task.sample_slot & IF_ACTIVE) != 0 && !brickIsActive(brick)) return;
  const uint sample_slot = task.sample_slot & ~IF_ACTIVE;
  const uint row_index = gl_LocalInvocationID.x;
  const uvec3 first = brick * BRICK_EDGE + uvec3(0, row_index % BRICK_EDGE, row_index / BRICK_EDGE);
  const uvec3 last = domainSize() - 1;
  const uint out_first = sample_slot * (BRICK_ROWS * BRICK_EDGE) + row_index * BRICK_EDGE;

  const uvec3 row = min(first, last);  // rows past the domain's end repeat the last one
  const Row centre = rowAt(brick.x, row.y, row.z);
  const uint y_before = row.y == 0 ? 0 : row.y - 1, y_after = min(row.y + 1, last.y);
  const uint z_before = row.z == 0 ? 0 : row.z - 1, z_after = min(row.z + 1, last.z);
  const Row before_y = rowAt(brick.x, y_before, row.z), after_y = rowAt(brick.x, y_after, row.z);
  const Row before_z = rowAt(brick.x, row.y, z_before), after_z = rowAt(brick.x, row.y, z_after);
  const float before_x = brick.x == 0 ? centre.low.x : rowAt(brick.x - 1, row.y, row.z).high.w;
  const bool has_next = first.x + BRICK_EDGE <= last.x;
  const float after_x = has_next ? rowAt(brick.x + 1, row.y, row.z).low.x : centre.high.w;

  const bool two_y = row.y > 0 && row.y < last.y;
  const bool two_z = row.z > 0 && row.z < last.z;
  const bool row_outside = any(greaterThan(first.yz, last.yz));
  for (uint i = 0; i < BRICK_EDGE; ++i) {
    const uint x = first.x + i;
    const float density = element(centre, i);
    vec3 gradient = vec3(0);
    if (x <= last.x && !row_outside) {
      const float left = i == 0 ? before_x : element(centre, i - 1);
      const float right = i == BRICK_EDGE - 1 ? after_x : element(centre, i + 1);
      gradient.x = axisGradient(left, right, x > 0 && x < last.x, push.inv_2h_x, push.inv_h_x);
      gradient.y = axisGradient(element(before_y, i), element(after_y, i), two_y, push.inv_2h_y, push.inv_h_y);
      gradient.z = axisGradient(element(before_z, i), element(after_z, i), two_z, push.inv_2h_z, push.inv_h_z);
    }
    samples[out_first + i] = vec4(gradient, density);
  }
}
