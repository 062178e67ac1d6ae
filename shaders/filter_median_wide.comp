// SPDX-License-Identifier: Apache-2.0
// shaders/filter_median_wide.comp: median of the box that reaches two voxels along i, and at most two along j and k. An
// invocation computes a row of eight results along i, from twelve columns of 25 ranks each. A column lies across i. A
// round takes two columns and makes two results. Reading rows and making rounds stay loops. Unrolled they would run 1.3
// times as fast, but lavapipe would compile them for 10 s.
#version 460
#extension GL_GOOGLE_include_directive : require
#include "filter.layout.h"

layout(local_size_x = FILTER_GROUP) in;
layout(push_constant) uniform Push { FilterPush push; };
#include "filter.glsl"
#include "filter_rank.math.glsl"
#include "filter_median_wide.math.glsl"
#include "filter_rows.glsl"

layout(constant_id = FILTER_CONSTANT_OWN + 1) const int kReachY = 2;
layout(constant_id = FILTER_CONSTANT_OWN + 2) const int kReachZ = 2;
const int kReachX = 2;
const int kEnd = int(BRICK_EDGE);
const int kRows = 25;

// These stand for voxels that the window does not hold: as many lowest as highest, so the median is unaffected.
const int kLowest = RANK_LOWEST, kHighest = RANK_HIGHEST;

int column[kEnd + 2 * kReachX][kRows];  // from two voxels before the row to two behind it

void readRow(uvec3 brick, uint row, int n) {
  const int dj = n % 5 - 2, dk = n / 5 - 2;
  const RowPlace place = rowPlace(brick, row, clamp(dj, -kReachY, kReachY), clamp(dk, -kReachZ, kReachZ));
  int rank[kEnd + 2 * kReachX];
  if (ownQuadsHold(kReachX)) {
    const BrickPage page = pages[place.page];
    const ivec4 low = rankOf(pageQuad(page, place.quad)), high = rankOf(pageQuad(page, place.quad + 1));
    for (int i = 0; i < 4; ++i) {
      rank[2 + i] = low[i];
      rank[6 + i] = high[i];
    }
  } else {
    for (int i = 0; i < kEnd; ++i) rank[2 + i] = rankOf(besideRow(place, brick, i));
  }
  rank[0] = rankOf(besideRow(place, brick, -2));
  rank[1] = rankOf(besideRow(place, brick, -1));
  rank[10] = rankOf(besideRow(place, brick, kEnd));
  rank[11] = rankOf(besideRow(place, brick, kEnd + 1));
  const bool held = abs(dj) <= kReachY && abs(dk) <= kReachZ;
  const int stand_in = n < kRows / 2 ? kLowest : kHighest;
  for (int c = 0; c < kEnd + 2 * kReachX; ++c) column[c][n] = held ? rank[c] : stand_in;
}

int median[4 + kEnd];

// Round p sorts columns 2 p and 2 p + 1. It makes the medians whose windows begin at columns 2 p - 4 and 2 p - 3. Both
// windows hold the four columns from 2 p - 3 on. The first two rounds have too few columns and make none.
void findMedians(int rounds) {
  int first[kRows], third[kRows], fourth[kRows];  // columns 2 p - 4, 2 p - 2, 2 p - 1
  int before[2 * kRows];                          // columns 2 p - 3 and 2 p - 2
  for (int i = 0; i < kRows; ++i) {
    first[i] = third[i] = fourth[i] = before[i] = before[i + kRows] = 0;
  }
  for (int p = 0; p < rounds; ++p) {
    int fifth[kRows], sixth[kRows], after[2 * kRows], middle[kRows + 1];
    for (int i = 0; i < kRows; ++i) {
      fifth[i] = column[2 * p][i];
      sixth[i] = column[2 * p + 1][i];
    }
    sortColumn(fifth);
    sortColumn(sixth);
    mergeColumns(fourth, fifth, after);
    middleOfFour(before, after, middle);
    median[2 * p] = middleOf(middle, first);
    median[2 * p + 1] = middleOf(middle, sixth);
    first = third;
    third = fifth;
    fourth = sixth;
    before = after;
  }
}

void main() {
  const uint task_index = gl_WorkGroupID.y * GROUPS_PER_ROW + gl_WorkGroupID.x;
  if (task_index >= push.task_count) return;
  const FilterTask task = tasks[push.first_task + task_index];
  const uvec3 brick = brickOfIndex(task.brick);
  const uint row = gl_LocalInvocationID.x;
  const bool always = push.task_count > 0;  // always true, but no compiler knows, so none unrolls the loop
  const int rows = always ? kRows : 0;
  for (int n = 0; n < rows; ++n) readRow(brick, row, n);
  findMedians(always ? (kEnd + 4) / 2 : 0);
  float found[kEnd];
  for (int i = 0; i < kEnd; ++i) found[i] = densityOf(median[i + 4]);
  if (kEdge != 0) {
    const int last = int(domainSize().x) - 1 - int(brick.x * BRICK_EDGE);
    for (int i = 1; i < kEnd; ++i) found[i] = i > last ? found[i - 1] : found[i];
  }
  const uint out_quad = task.slot * BRICK_QUADS + row * 2;
  result[out_quad] = vec4(found[0], found[1], found[2], found[3]);
  result[out_quad + 1] = vec4(found[4], found[5], found[6], found[7]);
}
