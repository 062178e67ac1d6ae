// SPDX-License-Identifier: Apache-2.0
// shaders/filter_median.comp: median of the box that reaches at most one voxel along each axis. An invocation computes
// a row of eight results along i, from ten columns of nine ranks each. A column lies across i.
#version 460
#extension GL_GOOGLE_include_directive : require
#include "filter.layout.h"

layout(local_size_x = FILTER_GROUP) in;
layout(push_constant) uniform Push { FilterPush push; };
#include "filter.glsl"
#include "filter_rank.math.glsl"
#include "filter_median.math.glsl"
#include "filter_rows.glsl"

layout(constant_id = FILTER_CONSTANT_OWN) const int kReachX = 1;
layout(constant_id = FILTER_CONSTANT_OWN + 1) const int kReachY = 1;
layout(constant_id = FILTER_CONSTANT_OWN + 2) const int kReachZ = 1;
const int kEnd = int(BRICK_EDGE);

void main() {
  const uint task_index = gl_WorkGroupID.y * GROUPS_PER_ROW + gl_WorkGroupID.x;
  if (task_index >= push.task_count) return;
  const FilterTask task = tasks[push.first_task + task_index];
  const uvec3 brick = brickOfIndex(task.brick);
  const uint row = gl_LocalInvocationID.x;

  int column[kEnd + 2][9];
  for (int n = 0; n < 9; ++n) {
    const int dj = n % 3 - 1, dk = n / 3 - 1;
    if (abs(dj) > kReachY || abs(dk) > kReachZ) {
      // The window does not hold these voxels. Half of them count as lowest and half as highest, so the median is
      // unaffected.
      for (int c = 0; c < kEnd + 2; ++c) column[c][n] = n < 4 ? RANK_LOWEST : RANK_HIGHEST;
      continue;
    }
    const RowPlace place = rowPlace(brick, row, dj, dk);
    const BrickPage page = pages[place.page];
    const vec4 low = pageQuad(page, place.quad), high = pageQuad(page, place.quad + 1);
    for (int i = 0; i < 4; ++i) {
      column[1 + i][n] = rankOf(low[i]);
      column[5 + i][n] = rankOf(high[i]);
    }
    if (kReachX != 0) {
      column[0][n] = rankOf(besideRow(place, brick, -1));
      column[kEnd + 1][n] = rankOf(besideRow(place, brick, kEnd));
    }
  }
  for (int c = 0; c < kEnd + 2; ++c) sortNine(column[c]);

  int median[kEnd];
  for (int i = 0; i < kEnd; i += 2) {
    if (kReachX == 0) {
      median[i] = column[i + 1][4];
      median[i + 1] = column[i + 2][4];
    } else {
      int shared_ten[10];
      middleTen(column[i + 1], column[i + 2], shared_ten);
      median[i] = tenthOf(shared_ten, column[i]);
      median[i + 1] = tenthOf(shared_ten, column[i + 3]);
    }
  }
  if (kEdge != 0) {
    const int last = int(domainSize().x) - 1 - int(brick.x * BRICK_EDGE);
    for (int i = 1; i < kEnd; ++i) median[i] = i > last ? median[i - 1] : median[i];
  }
  float out_row[kEnd];
  for (int i = 0; i < kEnd; ++i) out_row[i] = densityOf(median[i]);
  const uint out_quad = task.slot * BRICK_QUADS + row * 2;
  result[out_quad] = vec4(out_row[0], out_row[1], out_row[2], out_row[3]);
  result[out_quad + 1] = vec4(out_row[4], out_row[5], out_row[6], out_row[7]);
}
