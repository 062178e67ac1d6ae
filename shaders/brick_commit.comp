// SPDX-License-Identifier: Apache-2.0
// shaders/brick_commit.comp: copies bricks that edit_stencil.comp wrote aside into their slots of the pool, and updates
// their pages.
#version 460
#extension GL_GOOGLE_include_directive : require
#include "edit.layout.h"

layout(local_size_x = BRICK_ROWS) in;
layout(push_constant) uniform Push { CommitPush push; };
layout(std430, binding = COMMIT_BINDING_PAGES) writeonly buffer Pages { BrickPage pages[]; };
layout(std430, binding = COMMIT_BINDING_SLAB) writeonly buffer Slab { vec4 slab[]; };
layout(std430, binding = COMMIT_BINDING_TASKS) readonly buffer Tasks { EditTask tasks[]; };
layout(std430, binding = COMMIT_BINDING_ASIDE) readonly buffer Aside { vec4 aside[]; };

void main() {
  const uint index = gl_WorkGroupID.y * GROUPS_PER_ROW + gl_WorkGroupID.x;
  if (index >= push.task_count) return;
  const uint row = gl_LocalInvocationID.x;
  const EditTask task = tasks[push.first_task + index];
  if (row == 0 && task.was_constant == 1) pages[task.brick] = BrickPage(task.slot, 0.0);
  const uint at = (task.slot % BRICKS_PER_DENSITY_SLAB) * BRICK_QUADS + row * 2;
  const uint from = (push.first_aside + index) * BRICK_QUADS + row * 2;
  slab[at] = aside[from];
  slab[at + 1] = aside[from + 1];
}
