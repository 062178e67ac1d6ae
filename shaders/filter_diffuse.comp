// SPDX-License-Identifier: Apache-2.0
// shaders/filter_diffuse.comp: one explicit time step of anisotropic diffusion over the six faces of each voxel.
// Nothing flows through the volume's border. A work group is a brick, an invocation a row of eight voxels.
#version 460
#extension GL_GOOGLE_include_directive : require
#include "filter.layout.h"

layout(local_size_x = FILTER_GROUP) in;
layout(push_constant) uniform Push { FilterPush push; };
#include "filter.glsl"
#include "filter_exp.math.glsl"
#include "filter_diffuse.math.glsl"
#include "filter_row_ends.glsl"

layout(constant_id = FILTER_CONSTANT_OWN) const bool kExponential = false;

void main() {
  const uint group = gl_WorkGroupID.y * GROUPS_PER_ROW + gl_WorkGroupID.x;
  if (group >= push.task_count) return;
  const FilterTask task = tasks[push.first_task + group];
  const uvec3 brick = brickOfIndex(task.brick);
  const uint row = gl_LocalInvocationID.x;
  const uvec3 last = domainSize() - 1;
  const uvec3 first = min(brick * BRICK_EDGE + uvec3(0, row % BRICK_EDGE, row / BRICK_EDGE), last);

  float here[kRowWide], before_y[kRowWide], after_y[kRowWide], before_z[kRowWide], after_z[kRowWide];
  READ_ROW(here, brick.x, first.y, first.z)
  READ_ROW(before_y, brick.x, first.y == 0 ? 0 : first.y - 1, first.z)
  READ_ROW(after_y, brick.x, min(first.y + 1, last.y), first.z)
  READ_ROW(before_z, brick.x, first.y, first.z == 0 ? 0 : first.z - 1)
  READ_ROW(after_z, brick.x, first.y, min(first.z + 1, last.z))
  const float rate_x = taps[0], rate_y = taps[1], rate_z = taps[2];
  const float inv_x = taps[3], inv_y = taps[4], inv_z = taps[5];
  float after[kRowWide];
  for (int i = 1; i + 1 < kRowWide; ++i) {
    const float f = here[i];
    const float x = axisInflow(here[i - 1], f, here[i + 1], rate_x, inv_x, kExponential);
    const float y = axisInflow(before_y[i], f, after_y[i], rate_y, inv_y, kExponential);
    const float z = axisInflow(before_z[i], f, after_z[i], rate_z, inv_z, kExponential);
    after[i] = diffused(f, x, y, z);
    if (i > 1 && first.x + i - 1 > last.x) after[i] = after[i - 1];
  }
  const uint out_quad = task.slot * BRICK_QUADS + row * 2;
  result[out_quad] = vec4(after[1], after[2], after[3], after[4]);
  result[out_quad + 1] = vec4(after[5], after[6], after[7], after[8]);
}
