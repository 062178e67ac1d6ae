// SPDX-License-Identifier: Apache-2.0
// shaders/window.comp: gathers the samples around the tool from bricks into one small dense box, which the servo reads.
// A work group is a brick, an invocation a row of eight voxels. Bricks without gradients give density and a zero
// gradient.
#version 460
#extension GL_GOOGLE_include_directive : require
#include "window.layout.h"

layout(local_size_x = BRICK_ROWS) in;
layout(push_constant) uniform Push { WindowPush push; };
#define POOL_DOMAIN push.domain
#include "brick_pool.glsl"

layout(std430, binding = WINDOW_BINDING_TASKS) readonly buffer Tasks { BrickTask tasks[]; };
layout(std430, binding = WINDOW_BINDING_SAMPLES) readonly buffer Samples { uvec4 samples[]; };
layout(std430, binding = WINDOW_BINDING_WINDOW) writeonly buffer Window { vec4 window[]; };
layout(std430, binding = WINDOW_BINDING_BOUNDS) readonly buffer Bounds { BrickBounds bounds[]; };
#define ACTIVE_ISOVALUES push.isovalues
#include "active_brick.glsl"
#define SAMPLE_CODE push.code  // with the inverse scales
#include "sample_code.glsl"

layout(constant_id = WINDOW_CONSTANT_HALF) const uint kHalf = 0;

vec4 sampleAt(uint at) {
  if (kHalf == 0) return uintBitsToFloat(samples[at]);
  const uvec4 pair = samples[at / 2];
  return unpackedSample((at & 1u) == 0 ? pair.xy : pair.zw);
}

void main() {
  if (gl_WorkGroupID.x >= push.task_count) return;
  const BrickTask task = tasks[push.first_task + gl_WorkGroupID.x];
  const uint row_index = gl_LocalInvocationID.x;
  const uvec3 first =
      brickOfIndex(task.brick) * BRICK_EDGE + uvec3(0, row_index % BRICK_EDGE, row_index / BRICK_EDGE);
  const uvec3 origin = uvec3(push.first_x, push.first_y, push.first_z);
  const uvec3 size = uvec3(push.window_x, push.window_y, push.window_z);
  // Unsigned wrap-around makes voxels before the origin huge, so one comparison tests both sides.
  const uvec2 at = first.yz - origin.yz;
  if (any(greaterThanEqual(at, size.yz))) return;

  const bool sampled = task.sample_slot != NO_SLOT &&
                       ((task.sample_slot & IF_ACTIVE) == 0 || brickIsActive(brickOfIndex(task.brick)));
  const uint from = (task.sample_slot & ~IF_ACTIVE) * (BRICK_ROWS * BRICK_EDGE) + row_index * BRICK_EDGE;
  Row row;
  if (!sampled) row = pageRow(pages[task.brick], row_index % BRICK_EDGE, row_index / BRICK_EDGE);
  for (uint i = 0; i < BRICK_EDGE; ++i) {
    const uint x = first.x + i - origin.x;
    if (x >= size.x) continue;
    window[(at.y * size.y + at.x) * size.x + x] =
        sampled ? sampleAt(from + i) : vec4(0, 0, 0, i < 4 ? row.low[i] : row.high[i - 4]);
  }
}
