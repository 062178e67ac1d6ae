// SPDX-License-Identifier: Apache-2.0
// shaders/gradient_row.glsl: the body of gradient.comp and gradient_smoothed.comp, which defines OWN_DENSITY.
#include "gradient_task.glsl"

layout(constant_id = GRADIENT_CONSTANT_STENCIL) const uint kStencil = GRADIENT_CENTRAL;

// The row at voxel coordinates (y, z) of brick column `brick_x`.
Row rowAt(uint brick_x, uint y, uint z) {
  const uint brick = brickIndex(uvec3(brick_x, y / BRICK_EDGE, z / BRICK_EDGE));
  return pageRow(pages[brick], y % BRICK_EDGE, z % BRICK_EDGE);
}

uint before(uint c, uint by) { return c < by ? 0 : c - by; }

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
  const Row before_y = rowAt(brick.x, before(row.y, 1), row.z), after_y = rowAt(brick.x, min(row.y + 1, last.y), row.z);
  const Row before_z = rowAt(brick.x, row.y, before(row.z, 1)), after_z = rowAt(brick.x, row.y, min(row.z + 1, last.z));
  const bool has_next = first.x + BRICK_EDGE <= last.x;
  const vec4 before_x = brick.x == 0 ? centre.low : rowAt(brick.x - 1, row.y, row.z).high;
  const vec4 after_x = has_next ? rowAt(brick.x + 1, row.y, row.z).low : centre.high;
  const float left_x = brick.x == 0 ? before_x.x : before_x.w;
  const float right_x = has_next ? after_x.x : after_x.w;

  const bool two_y = row.y > 0 && row.y < last.y;
  const bool two_z = row.z > 0 && row.z < last.z;
  const bool row_outside = any(greaterThan(first.yz, last.yz));
  // Two voxels away; what is read instead where there are none is not used.
  Row before2_y, after2_y, before2_z, after2_z;
  if (kStencil == GRADIENT_CENTRAL4) {
    before2_y = rowAt(brick.x, before(row.y, 2), row.z);
    after2_y = rowAt(brick.x, min(row.y + 2, last.y), row.z);
    before2_z = rowAt(brick.x, row.y, before(row.z, 2));
    after2_z = rowAt(brick.x, row.y, min(row.z + 2, last.z));
  }
  const bool four_y = kStencil == GRADIENT_CENTRAL4 && row.y > 1 && row.y + 1 < last.y;
  const bool four_z = kStencil == GRADIENT_CENTRAL4 && row.z > 1 && row.z + 1 < last.z;
#ifdef OWN_DENSITY
  const Row densities = densityRow(task.brick, row_index);
#define DENSITIES densities
#else
#define DENSITIES centre
#endif
  vec4 previous = vec4(0);
  for (uint i = 0; i < BRICK_EDGE; ++i) {
    const uint x = first.x + i;
    vec3 gradient = vec3(0);
    if (x <= last.x && !row_outside) {
      const float left = i == 0 ? left_x : element(centre, i - 1);
      const float right = i == BRICK_EDGE - 1 ? right_x : element(centre, i + 1);
      gradient.x = axisGradient(left, right, x > 0 && x < last.x, push.inv_2h_x, push.inv_h_x);
      gradient.y = axisGradient(element(before_y, i), element(after_y, i), two_y, push.inv_2h_y, push.inv_h_y);
      gradient.z = axisGradient(element(before_z, i), element(after_z, i), two_z, push.inv_2h_z, push.inv_h_z);
      if (kStencil == GRADIENT_CENTRAL4) {
        const float left2 = i < 2 ? before_x[i + 2] : element(centre, i - 2);
        const float right2 = i > BRICK_EDGE - 3 ? after_x[i - (BRICK_EDGE - 2)] : element(centre, i + 2);
        if (x > 1 && x + 1 < last.x) gradient.x = axisGradient4(left2, left, right, right2, push.inv_12h_x);
        if (four_y)
          gradient.y = axisGradient4(element(before2_y, i), element(before_y, i), element(after_y, i),
                                     element(after2_y, i), push.inv_12h_y);
        if (four_z)
          gradient.z = axisGradient4(element(before2_z, i), element(before_z, i), element(after_z, i),
                                     element(after2_z, i), push.inv_12h_z);
      }
    }
    const vec4 value = vec4(gradient, element(DENSITIES, i));
    writeSample(out_first + i, previous, value);
    previous = value;
  }
}
