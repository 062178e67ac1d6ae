// SPDX-License-Identifier: Apache-2.0
// shaders/gradient_sobel.comp: plane-ready samples by the Sobel operator of 3x3x3 voxels: along an axis the central
// difference, across it weights 1, 2, 1, which the scale divides out. Beyond the border the outermost voxel repeats;
// there the difference is one-sided.
//
// An invocation goes through a brick along k with a row of eight voxels, so that the nine rows around a row cost three
// new ones each time; a work group is SOBEL_BRICKS bricks.
#version 460
#extension GL_GOOGLE_include_directive : require
#include "gradient.layout.h"

layout(local_size_x = SOBEL_BRICKS * BRICK_EDGE) in;
layout(push_constant) uniform Push { GradientPush push; };
#define POOL_DOMAIN push.domain
#include "brick_pool.glsl"
#include "gradient_task.glsl"

// Three rows one above the other along j: what of them a gradient needs.
struct Slice {
  vec4 density_low, density_high;  // of the middle row
  float left, right;               // smoothed along j: before the row,
  vec4 low, high;                  // its eight voxels, and behind it
  vec4 difference_low, difference_high;  // smoothed along i: the last row less the first
  vec4 smooth_low, smooth_high;          // smoothed along i, then j
};

struct WideRow {
  float left, right;  // the densities beside a row
  Row row;
};

// Pages of three bricks along i; where there is none on a side, the middle one again.
struct PageLine {
  BrickPage before, middle, after;
};

WideRow wideRow(PageLine p, bool has_before, bool has_after, uint y, uint z) {
  WideRow wide;
  wide.row = pageRow(p.middle, y, z);
  const Row before = pageRow(p.before, y, z), after = pageRow(p.after, y, z);
  wide.left = has_before ? before.high.w : wide.row.low.x;
  wide.right = has_after ? after.low.x : wide.row.high.w;
  return wide;
}

PageLine pagesAt(uvec3 brick, bool has_before, bool has_after) {
  const uint middle = brickIndex(brick);
  return PageLine(pages[has_before ? middle - 1 : middle], pages[middle], pages[has_after ? middle + 1 : middle]);
}

// Along i: the neighbours of each element of a row.
vec4 leftOfLow(WideRow r) { return vec4(r.left, r.row.low.xyz); }
vec4 rightOfLow(WideRow r) { return vec4(r.row.low.yzw, r.row.high.x); }
vec4 leftOfHigh(WideRow r) { return vec4(r.row.low.w, r.row.high.xyz); }
vec4 rightOfHigh(WideRow r) { return vec4(r.row.high.yzw, r.right); }

struct Column {
  PageLine before, middle, after;  // for the row before along j, the middle row and the one after
};

Slice sliceAt(Column c, bool has_before, bool has_after, uint y_before, uint y, uint y_after, uint z) {
  const WideRow a = wideRow(c.before, has_before, has_after, y_before, z);
  const WideRow b = wideRow(c.middle, has_before, has_after, y, z);
  const WideRow d = wideRow(c.after, has_before, has_after, y_after, z);
  Slice s;
  s.density_low = b.row.low;
  s.density_high = b.row.high;
  s.left = smoothed3(a.left, b.left, d.left);
  s.right = smoothed3(a.right, b.right, d.right);
  s.low = smoothed3(a.row.low, b.row.low, d.row.low);
  s.high = smoothed3(a.row.high, b.row.high, d.row.high);
  const vec4 a_low = smoothed3(leftOfLow(a), a.row.low, rightOfLow(a));
  const vec4 a_high = smoothed3(leftOfHigh(a), a.row.high, rightOfHigh(a));
  const vec4 b_low = smoothed3(leftOfLow(b), b.row.low, rightOfLow(b));
  const vec4 b_high = smoothed3(leftOfHigh(b), b.row.high, rightOfHigh(b));
  const vec4 d_low = smoothed3(leftOfLow(d), d.row.low, rightOfLow(d));
  const vec4 d_high = smoothed3(leftOfHigh(d), d.row.high, rightOfHigh(d));
  precise vec4 difference_low = d_low - a_low;
  precise vec4 difference_high = d_high - a_high;
  s.difference_low = difference_low;
  s.difference_high = difference_high;
  s.smooth_low = smoothed3(a_low, b_low, d_low);
  s.smooth_high = smoothed3(a_high, b_high, d_high);
  return s;
}

// Where the brick lies and where its samples go.
uvec3 first_of_column;
uint out_first;

// The row at `z` of the brick, from its slice and those before and after it.
void writeRow(Slice before, Slice here, Slice after, uint z) {
  const uvec3 last = domainSize() - 1;
  const uvec3 first = first_of_column + uvec3(0, 0, z);
  const bool outside = any(greaterThan(first.yz, last.yz));
  const float scale_y = first.y > 0 && first.y < last.y ? push.inv_2h_y : push.inv_h_y;
  const float scale_z = first.z > 0 && first.z < last.z ? push.inv_2h_z : push.inv_h_z;
  const vec4 low = smoothed3(before.low, here.low, after.low);
  const vec4 high = smoothed3(before.high, here.high, after.high);
  const float left = smoothed3(before.left, here.left, after.left);
  const float right = smoothed3(before.right, here.right, after.right);
  const vec4 y_low = smoothed3(before.difference_low, here.difference_low, after.difference_low);
  const vec4 y_high = smoothed3(before.difference_high, here.difference_high, after.difference_high);
  precise vec4 z_low = after.smooth_low - before.smooth_low;
  precise vec4 z_high = after.smooth_high - before.smooth_high;
  const Row along_x = Row(low, high), along_y = Row(y_low, y_high), along_z = Row(z_low, z_high);
  const Row densities = Row(here.density_low, here.density_high);
  vec4 previous = vec4(0);
  for (uint i = 0; i < BRICK_EDGE; ++i) {
    const uint x = first.x + i;
    vec3 gradient = vec3(0);
    if (x <= last.x && !outside) {
      const float x_before = i == 0 ? left : element(along_x, i - 1);
      const float x_after = i == BRICK_EDGE - 1 ? right : element(along_x, i + 1);
      gradient.x = axisGradient(x_before, x_after, x > 0 && x < last.x, push.inv_2h_x, push.inv_h_x);
      gradient.y = scaled(element(along_y, i), scale_y);
      gradient.z = scaled(element(along_z, i), scale_z);
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
