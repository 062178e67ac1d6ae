// SPDX-License-Identifier: Apache-2.0
// shaders/gradient_sobel.comp: samples by the Sobel operator of 3x3x3 voxels: the central difference along an axis,
// weighted by 1, 2, 1 across it. The scale divides by the sum of the weights. Beyond the border the outermost voxel
// repeats, and the difference is one-sided.
//
// An invocation goes through a brick along k with a row of eight voxels. So each step needs only three new rows of the
// nine around it. A work group is SOBEL_BRICKS bricks.
#version 460
#extension GL_GOOGLE_include_directive : require
#include "gradient.layout.h"

layout(local_size_x = SOBEL_BRICKS * BRICK_EDGE) in;
layout(push_constant) uniform Push { GradientPush push; };
#define POOL_DOMAIN push.domain
#include "brick_pool.glsl"
#include "gradient_task.glsl"
#include "gradient_sobel.math.glsl"

// A slice, and the densities of its middle row for the samples.
struct Slice {
  vec4 density_low, density_high;
  SobelSlice parts;
};

// Pages of three bricks along i. If a neighbour is missing, the middle brick stands for it.
struct PageLine {
  BrickPage before, middle, after;
};

SobelRow wideRow(PageLine p, bool has_before, bool has_after, uint y, uint z) {
  const Row row = pageRow(p.middle, y, z);
  const Row before = pageRow(p.before, y, z), after = pageRow(p.after, y, z);
  SobelRow wide;
  wide.left = has_before ? before.high.w : row.low.x;
  wide.right = has_after ? after.low.x : row.high.w;
  wide.low = row.low;
  wide.high = row.high;
  return wide;
}

PageLine pagesAt(uvec3 brick, bool has_before, bool has_after) {
  const uint middle = brickIndex(brick);
  return PageLine(pages[has_before ? middle - 1 : middle], pages[middle], pages[has_after ? middle + 1 : middle]);
}

struct Column {
  PageLine before, middle, after;  // for the row before along j, the middle row and the one after
};

Slice sliceAt(Column c, bool has_before, bool has_after, uint y_before, uint y, uint y_after, uint z) {
  const SobelRow middle = wideRow(c.middle, has_before, has_after, y, z);
  Slice slice;
  slice.density_low = middle.low;
  slice.density_high = middle.high;
  slice.parts = sobelSlice(wideRow(c.before, has_before, has_after, y_before, z), middle,
                           wideRow(c.after, has_before, has_after, y_after, z));
  return slice;
}

// Where the brick lies and where its samples go.
uvec3 first_of_column;
uint out_first;

// The row at `z` of the brick, from its slice and those before and after it.
void writeRow(Slice before, Slice here, Slice after, uint z) {
  const uvec3 last = domainSize() - 1;
  const uvec3 first = first_of_column + uvec3(0, 0, z);
  const bool outside = any(greaterThan(first.yz, last.yz));
  const SobelDifferences parts = sobelDifferences(before.parts, here.parts, after.parts);
  const Row along_x = Row(parts.x_low, parts.x_high), along_y = Row(parts.y_low, parts.y_high);
  const Row along_z = Row(parts.z_low, parts.z_high), densities = Row(here.density_low, here.density_high);
  vec4 previous = vec4(0);
  for (uint i = 0; i < BRICK_EDGE; ++i) {
    const uint x = first.x + i;
    vec3 gradient = vec3(0);
    if (x <= last.x && !outside) {
      gradient.x = sobelGradient(element(along_x, i), x, last.x, push.inv_2h_x, push.inv_h_x);
      gradient.y = sobelGradient(element(along_y, i), first.y, last.y, push.inv_2h_y, push.inv_h_y);
      gradient.z = sobelGradient(element(along_z, i), first.z, last.z, push.inv_2h_z, push.inv_h_z);
    }
    const vec4 value = vec4(gradient, element(densities, i));
    writeSample(out_first + z * (BRICK_EDGE * BRICK_EDGE) + i, previous, value);
    previous = value;
  }
}

Column columnAt(uvec3 brick, uint y_brick_before, uint y_brick_after, bool has_before, bool has_after) {
  return Column(pagesAt(uvec3(brick.x, y_brick_before, brick.z), has_before, has_after),
                pagesAt(brick, has_before, has_after),
                pagesAt(uvec3(brick.x, y_brick_after, brick.z), has_before, has_after));
}

void main() {
  const uint group = gl_WorkGroupID.y * GROUPS_PER_ROW + gl_WorkGroupID.x;
  const uint task_index = group * SOBEL_BRICKS + gl_LocalInvocationID.x / BRICK_EDGE;
  if (task_index >= push.task_count) return;
  const BrickTask task = tasks[push.first_task + task_index];
  const uvec3 brick = brickOfIndex(task.brick);
  if ((task.sample_slot & IF_ACTIVE) != 0 && !brickIsActive(brick)) return;
  const uint y = gl_LocalInvocationID.x % BRICK_EDGE;
  first_of_column = brick * BRICK_EDGE + uvec3(0, y, 0);
  out_first = (task.sample_slot & ~IF_ACTIVE) * (BRICK_ROWS * BRICK_EDGE) + y * BRICK_EDGE;

  // Voxels of a brick outside the domain repeat the nearest one inside, so only missing bricks need care.
  const uvec3 end = uvec3(POOL_DOMAIN.bricks_x, POOL_DOMAIN.bricks_y, POOL_DOMAIN.bricks_z) - 1;
  const bool has_before = brick.x > 0, has_after = brick.x < end.x;
  const bool steps_down = y == 0 && brick.y > 0, steps_up = y == BRICK_EDGE - 1 && brick.y < end.y;
  const uint y_brick_before = steps_down ? brick.y - 1 : brick.y, y_brick_after = steps_up ? brick.y + 1 : brick.y;
  const uint y_before = steps_down ? BRICK_EDGE - 1 : max(y, 1u) - 1;
  const uint y_after = steps_up ? 0 : min(y + 1, BRICK_EDGE - 1);
#define SLICE(column, z) sliceAt(column, has_before, has_after, y_before, y, y_after, z)
#define COLUMN(z_brick) columnAt(uvec3(brick.xy, z_brick), y_brick_before, y_brick_after, has_before, has_after)

  const bool has_below = brick.z > 0, has_above = brick.z < end.z;
  const Column below = COLUMN(has_below ? brick.z - 1 : brick.z);
  Slice before = SLICE(below, has_below ? BRICK_EDGE - 1 : 0);
  const Column own = COLUMN(brick.z);
  Slice here = SLICE(own, 0);
  for (uint z = 1; z < BRICK_EDGE; ++z) {
    const Slice after = SLICE(own, z);
    writeRow(before, here, after, z - 1);
    before = here;
    here = after;
  }
  const Column above = COLUMN(has_above ? brick.z + 1 : brick.z);
  writeRow(before, here, SLICE(above, has_above ? 0 : BRICK_EDGE - 1), BRICK_EDGE - 1);
}
