// SPDX-License-Identifier: Apache-2.0
// shaders/edit.comp: runs edit commands over listed bricks, in place. A work group is a brick, an invocation a row of
// eight voxels. For each voxel the commands follow one another. None of them reads a neighbour, so nothing has to wait.
#version 460
#extension GL_GOOGLE_include_directive : require
#include "edit.layout.h"

layout(local_size_x = BRICK_ROWS) in;
layout(constant_id = 0) const uint kKind = EDIT_REMOVE;  // of all commands of a run
layout(push_constant) uniform Push { EditPush push; };
layout(std430, binding = EDIT_BINDING_PAGES) writeonly buffer Pages { BrickPage pages[]; };
layout(std430, binding = EDIT_BINDING_SLAB) buffer Slab { vec4 slab[]; };
layout(std430, binding = EDIT_BINDING_TASKS) readonly buffer Tasks { EditTask tasks[]; };
layout(std430, binding = EDIT_BINDING_COMMANDS) readonly buffer Commands { EditCommand commands[]; };
layout(std430, binding = EDIT_BINDING_STAMPS) readonly buffer Stamps { float stamps[]; };
#include "edit.math.glsl"
#include "edit_stamp.glsl"

vec4 stampedDepth(EditCommand c, vec4 px, float py, float pz, out bvec4 reached) {
  vec4 depth;
  bool inside;
  for (uint i = 0; i < 4; ++i) {
    depth[i] = -stampDistance(c, px[i], py, pz, inside);
    reached[i] = inside && depth[i] >= -c.reach;
  }
  return depth;
}

vec4 edited(EditCommand c, vec4 px, float py, float pz, vec4 f) {
  if (kKind == EDIT_CUT) {
    const vec4 height = planeHeight(c, px, py, pz);
    return blend(f, clearedTarget(c, f, height), vec4(c.strength),
                 greaterThanEqual(height, vec4(-c.reach)));
  }
  if (kKind == EDIT_STAMP_ADD || kKind == EDIT_STAMP_REMOVE) {
    bvec4 reached;
    const vec4 depth = stampedDepth(c, px, py, pz, reached);
    const vec4 target = kKind == EDIT_STAMP_ADD ? filledTarget(c, f, depth) : clearedTarget(c, f, depth);
    return blend(f, target, vec4(c.strength), reached);
  }
  const vec4 distance = strokeDistance(c, px, py, pz);
  const bvec4 reached = lessThanEqual(distance, vec4(c.reach));
  precise vec4 depth = c.radius - distance;
  precise vec4 amount = amountAt(c, distance);
  vec4 target = vec4(c.value);
  if (kKind == EDIT_ADD) target = filledTarget(c, f, depth);
  if (kKind == EDIT_REMOVE) {
    target = clearedTarget(c, f, depth);
    if (c.material_drop > 0.0) amount = amount * materialRate(c, f);
  }
  if (kKind == EDIT_FLATTEN) {
    const vec4 height = planeHeight(c, px, py, pz);
    precise vec4 ramp = c.isovalue - c.slope * height;
    target = lesser(greater(ramp, vec4(c.background)), vec4(c.object));
  }
  return blend(f, target, amount, reached);
}

void main() {
  const uint index = gl_WorkGroupID.y * GROUPS_PER_ROW + gl_WorkGroupID.x;
  if (index >= push.task_count) return;
  const EditTask task = tasks[push.first_task + index];
  const uint row = gl_LocalInvocationID.x;
  if (row == 0 && task.slot == NO_SLOT) pages[task.brick] = BrickPage(NO_SLOT, task.constant);
  if (task.slot == NO_SLOT) return;
  if (row == 0 && task.was_constant == 1) pages[task.brick] = BrickPage(task.slot, 0.0);

  // Voxels past the domain repeat the last one inside: they get its position, so they get its density.
  const uint slice = push.domain.bricks_x * push.domain.bricks_y;
  const uvec3 brick = uvec3(task.brick % slice % push.domain.bricks_x, task.brick % slice / push.domain.bricks_x,
                            task.brick / slice);
  const ivec3 last = ivec3(push.domain.size_x, push.domain.size_y, push.domain.size_z) - 1;
  const ivec3 first = ivec3(brick * BRICK_EDGE + uvec3(0, row % BRICK_EDGE, row / BRICK_EDGE));
  const ivec4 x_low = min(ivec4(first.x) + ivec4(0, 1, 2, 3), ivec4(last.x));
  const ivec4 x_high = min(ivec4(first.x) + ivec4(4, 5, 6, 7), ivec4(last.x));
  const int y = min(first.y, last.y), z = min(first.z, last.z);

  const uint at = (task.slot % BRICKS_PER_DENSITY_SLAB) * BRICK_QUADS + row * 2;
  vec4 low = vec4(task.constant), high = vec4(task.constant);
  if (task.was_constant == 0) {
    low = slab[at];
    high = slab[at + 1];
  }
  for (uint i = 0; i < push.command_count; ++i) {
    const EditCommand c = commands[push.first_command + i];
    precise vec4 px_low = vec4(x_low - c.origin_x) * push.h_x;
    precise vec4 px_high = vec4(x_high - c.origin_x) * push.h_x;
    precise float py = float(y - c.origin_y) * push.h_y;
    precise float pz = float(z - c.origin_z) * push.h_z;
    low = edited(c, px_low, py, pz, low);
    high = edited(c, px_high, py, pz, high);
  }
  slab[at] = low;
  slab[at + 1] = high;
}
