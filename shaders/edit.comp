// SPDX-License-Identifier: Apache-2.0
// shaders/edit.comp: runs edit commands over listed bricks, in place. A work group is a brick, an invocation a row of
// eight voxels. A voxel goes through the commands one after another. None of them reads a neighbour, so no invocation
// has to wait.
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
#include "numbers.math.glsl"
#include "edit.math.glsl"
#include "edit_stamp.math.glsl"

// The four corners of a cell on one side along the stamp's third axis.
vec4 stampCorners(uint first, uint row) {
  return vec4(stamps[first], stamps[first + 1], stamps[first + row], stamps[first + row + 1]);
}

vec4 stampedRow(EditCommand c, vec4 px, float py, float pz, vec4 f) {
  vec4 distance = vec4(0);
  bvec4 inside;
  for (uint i = 0; i < 4; ++i) {
    const StampPlace place = stampPlace(c, px[i], py, pz);
    inside[i] = place.inside;
    if (!place.inside) continue;
    distance[i] = stampDistance(place, stampCorners(place.first, c.stamp_x),
                                stampCorners(place.first + c.stamp_x * c.stamp_y, c.stamp_x));
  }
  return stamped(kKind, c, distance, inside, f);
}

vec4 editedRow(EditCommand c, vec4 px, float py, float pz, vec4 f) {
  if (kKind == EDIT_STAMP_ADD || kKind == EDIT_STAMP_REMOVE) return stampedRow(c, px, py, pz, f);
  return edited(kKind, c, px, py, pz, f);
}

void main() {
  const uint index = gl_WorkGroupID.y * GROUPS_PER_ROW + gl_WorkGroupID.x;
  if (index >= push.task_count) return;
  const EditTask task = tasks[push.first_task + index];
  const uint row = gl_LocalInvocationID.x;
  if (row == 0 && task.slot == NO_SLOT) pages[task.brick] = BrickPage(NO_SLOT, task.constant);
  if (task.slot == NO_SLOT) return;
  if (row == 0 && task.was_constant == 1) pages[task.brick] = BrickPage(task.slot, 0.0);

  // Voxels past the domain repeat the last one inside. They get its position, and so its density.
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
    const float py = placeAlong(y, c.origin_y, push.scale.h_y);
    const float pz = placeAlong(z, c.origin_z, push.scale.h_z);
    low = editedRow(c, placesAlong(x_low, c.origin_x, push.scale.h_x), py, pz, low);
    high = editedRow(c, placesAlong(x_high, c.origin_x, push.scale.h_x), py, pz, high);
  }
  slab[at] = low;
  slab[at + 1] = high;
}
