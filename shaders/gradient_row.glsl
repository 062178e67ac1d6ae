// SPDX-License-Identifier: Apache-2.0
// shaders/gradient_row.glsl: the body of gradient.comp, gradient_central4.comp and gradient_smoothed.comp. The second
// defines FOURTH_ORDER, the third OWN_DENSITY.
#include "gradient_task.glsl"

#ifdef FOURTH_ORDER
const bool kFourth = true;
#else
const bool kFourth = false;
#endif

layout(constant_id = GRADIENT_CONSTANT_RUN) const int kRun = 8;

const int kFar = 2;  // reach of the widest stencil, to either side [voxel]

// Row (y, z) of the domain, in the bricks of column `brick_x`.
Row rowAt(uint brick_x, uint y, uint z) {
  const uint brick = brickIndex(uvec3(brick_x, y / BRICK_EDGE, z / BRICK_EDGE));
  return pageRow(pages[brick], y % BRICK_EDGE, z % BRICK_EDGE);
}

// One density of a row of a page.
float rowElement(BrickPage page, uint y, uint z, uint i) {
  if (page.slot == NO_SLOT) return page.constant;
  return slabElement(page.slot, ((z % BRICK_EDGE) * BRICK_EDGE + y % BRICK_EDGE) * 2 + i / 4, i % 4);
}

uint inside(int c, uint last) { return uint(clamp(c, 0, int(last))); }

void main() {
  const uint task_index = gl_WorkGroupID.y * GROUPS_PER_ROW + gl_WorkGroupID.x;
  if (task_index >= push.task_count) return;
  const BrickTask task = tasks[push.first_task + task_index];
  const uvec3 brick = brickOfIndex(task.brick);
  if ((task.sample_slot & IF_ACTIVE) != 0 && !brickIsActive(brick)) return;
  const uint sample_slot = task.sample_slot & ~IF_ACTIVE;
  const uint line = gl_LocalInvocationID.x;
  const uvec3 in_brick = uvec3(0, line % BRICK_EDGE, line / BRICK_EDGE * uint(kRun));
  const uvec3 first = brick * BRICK_EDGE + in_brick;
  const uvec3 last = domainSize() - 1;
  const uint reach = kFourth ? 2 : 1;

  // Rows and columns past the domain's end repeat the last one. The repeated rows are used only for one-sided
  // differences, which take the row itself.
  const uint y = min(first.y, last.y);
  const BrickPage page = pages[task.brick];
  Row behind[kRun + 2 * kFar];  // along k, from kFar before the first
  [[unroll]] for (int n = 0; n < kRun + 2 * kFar; ++n) {
    if (n < kFar - int(reach) || n >= kRun + kFar + int(reach)) continue;
    const uint z = inside(int(first.z) + n - kFar, last.z);
    if (n >= kFar && n < kRun + kFar) {
      behind[n] = pageRow(page, y % BRICK_EDGE, z % BRICK_EDGE);
    } else {
      behind[n] = rowAt(brick.x, y, z);
    }
  }
  const uint y_before = inside(int(y) - 1, last.y), y_after = min(y + 1, last.y);
  const BrickPage page_before_y = pages[brickIndex(uvec3(brick.x, y_before / BRICK_EDGE, brick.z))];
  const BrickPage page_after_y = pages[brickIndex(uvec3(brick.x, y_after / BRICK_EDGE, brick.z))];
  const bool has_previous = brick.x > 0, has_next = first.x + BRICK_EDGE <= last.x;
  const BrickPage page_before_x = pages[has_previous ? task.brick - 1 : task.brick];
  const BrickPage page_after_x = pages[has_next ? task.brick + 1 : task.brick];

  [[unroll]] for (int run = 0; run < kRun; ++run) {
    const uint z = min(first.z + run, last.z);
    const Row centre = behind[run + kFar], before_z = behind[run + kFar - 1], after_z = behind[run + kFar + 1];
    const Row before_y = pageRow(page_before_y, y_before % BRICK_EDGE, z % BRICK_EDGE);
    const Row after_y = pageRow(page_after_y, y_after % BRICK_EDGE, z % BRICK_EDGE);
    const float left_x = rowElement(page_before_x, y, z, has_previous ? 7 : 0);
    const float right_x = rowElement(page_after_x, y, z, has_next ? 0 : 7);
    float left2_x, right2_x;
    Row before2_y, after2_y;
    if (kFourth) {
      left2_x = rowElement(page_before_x, y, z, 6);
      right2_x = rowElement(page_after_x, y, z, 1);
      before2_y = rowAt(brick.x, inside(int(y) - 2, last.y), z);
      after2_y = rowAt(brick.x, min(y + 2, last.y), z);
    }
    const bool row_outside = first.y > last.y || first.z + run > last.z;
    const uint row_index = (in_brick.z + run) * BRICK_EDGE + in_brick.y;
    const uint out_first = sample_slot * (BRICK_ROWS * BRICK_EDGE) + row_index * BRICK_EDGE;
#ifdef OWN_DENSITY
    const Row densities = densityRow(task.brick, row_index);
#else
    const Row densities = centre;
#endif
    vec4 previous = vec4(0);
    [[unroll]] for (uint i = 0; i < BRICK_EDGE; ++i) {
      const uint x = first.x + i;
      vec3 gradient = vec3(0);
      if (x <= last.x && !row_outside) {
        const float left = i == 0 ? left_x : element(centre, i - 1);
        const float right = i == BRICK_EDGE - 1 ? right_x : element(centre, i + 1);
        float left2 = 0, right2 = 0, before2_yi = 0, after2_yi = 0, before2_zi = 0, after2_zi = 0;
        if (kFourth) {
          left2 = i == 0 ? left2_x : i == 1 ? left_x : element(centre, i - 2);
          right2 = i == BRICK_EDGE - 1 ? right2_x : i == BRICK_EDGE - 2 ? right_x : element(centre, i + 2);
          before2_yi = element(before2_y, i);
          after2_yi = element(after2_y, i);
          before2_zi = element(behind[run + kFar - 2], i);
          after2_zi = element(behind[run + kFar + 2], i);
        }
        gradient.x = stencilGradient(kFourth, x, last.x, left2, left, right, right2, push.inv_2h_x, push.inv_h_x,
                                     push.inv_12h_x);
        gradient.y = stencilGradient(kFourth, y, last.y, before2_yi, element(before_y, i), element(after_y, i),
                                     after2_yi, push.inv_2h_y, push.inv_h_y, push.inv_12h_y);
        gradient.z = stencilGradient(kFourth, z, last.z, before2_zi, element(before_z, i), element(after_z, i),
                                     after2_zi, push.inv_2h_z, push.inv_h_z, push.inv_12h_z);
      }
      const vec4 value = vec4(gradient, element(densities, i));
      writeSample(out_first + i, previous, value);
      previous = value;
    }
  }
}
