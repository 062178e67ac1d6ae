// SPDX-License-Identifier: Apache-2.0
// shaders/filter_median_search.comp: median of any box. It halves the range of ranks between the box's lowest and
// highest. The number of voxels at or below the middle rank tells which half holds the median. An invocation computes a
// row of eight results along i. It reads the window again for each halving, some thirty times. That is slow, so it is
// for windows too large to sort.
#version 460
#extension GL_GOOGLE_include_directive : require
#include "filter.layout.h"

layout(local_size_x = FILTER_GROUP) in;
layout(push_constant) uniform Push { FilterPush push; };
#include "filter.glsl"
#include "filter_rank.math.glsl"
#include "filter_rows.glsl"

layout(constant_id = FILTER_CONSTANT_OWN) const int kReachX = 1;
layout(constant_id = FILTER_CONSTANT_OWN + 1) const int kReachY = 1;
layout(constant_id = FILTER_CONSTANT_OWN + 2) const int kReachZ = 1;
const int kEnd = int(BRICK_EDGE);
const int kRowsAlongJ = 2 * kReachY + 1;
const int kRows = kRowsAlongJ * (2 * kReachZ + 1);
const int kMiddle = (kRows * (2 * kReachX + 1) + 1) / 2;  // number of ranks at or below the median
const int kLargest = 3;                                   // reach along i

int rank[kEnd + 2 * kLargest];  // of one row, from kReachX voxels before it to kReachX behind it

void readRow(uvec3 brick, uint row, int n) {
  const RowPlace place = rowPlace(brick, row, n % kRowsAlongJ - kReachY, n / kRowsAlongJ - kReachZ);
  for (int c = 0; c < kEnd + 2 * kLargest; ++c) {
    const int at = c - kLargest;
    const bool own = at >= 0 && at < kEnd && ownQuadsHold(kReachX);
    if (!own && at >= -kReachX && at < kEnd + kReachX) rank[c] = rankOf(besideRow(place, brick, at));
  }
  if (ownQuadsHold(kReachX)) {
    const BrickPage page = pages[place.page];
    const vec4 low = pageQuad(page, place.quad), high = pageQuad(page, place.quad + 1);
    for (int i = 0; i < 4; ++i) {
      rank[kLargest + i] = rankOf(low[i]);
      rank[kLargest + 4 + i] = rankOf(high[i]);
    }
  }
}

// Runs over each result o and each rank of the row in its window.
#define EACH_IN_WINDOW(DO)                                              \
  for (int c = 0; c < kEnd + 2 * kLargest; ++c) {                       \
    for (int o = 0; o < kEnd; ++o) {                                    \
      if (abs(c - kLargest - o) <= kReachX) { DO(o, rank[c]) }          \
    }                                                                   \
  }
#define WIDEN(o, r) range[o] = widened(range[o], r);
#define COUNT(o, r) count[o] += r <= middle[o] ? 1 : 0;

void main() {
  const uint task_index = gl_WorkGroupID.y * GROUPS_PER_ROW + gl_WorkGroupID.x;
  if (task_index >= push.task_count) return;
  const FilterTask task = tasks[push.first_task + task_index];
  const uvec3 brick = brickOfIndex(task.brick);
  const uint row = gl_LocalInvocationID.x;

  RankRange range[kEnd];
  int middle[kEnd], count[kEnd];
  for (int o = 0; o < kEnd; ++o) range[o] = noRange();
  for (int n = 0; n < kRows; ++n) {
    readRow(brick, row, n);
    EACH_IN_WINDOW(WIDEN)
  }
  for (int halving = 0; halving < 32; ++halving) {
    bool found = true;
    for (int o = 0; o < kEnd; ++o) {
      found = found && range[o].lowest == range[o].highest;
      middle[o] = halfway(range[o].lowest, range[o].highest);
      count[o] = 0;
    }
    if (found) break;
    for (int n = 0; n < kRows; ++n) {
      readRow(brick, row, n);
      EACH_IN_WINDOW(COUNT)
    }
    for (int o = 0; o < kEnd; ++o) range[o] = halved(range[o], count[o], kMiddle);
  }
  if (kEdge != 0) {
    const int last = int(domainSize().x) - 1 - int(brick.x * BRICK_EDGE);
    for (int o = 1; o < kEnd; ++o) range[o].lowest = o > last ? range[o - 1].lowest : range[o].lowest;
  }
  const uint out_quad = task.slot * BRICK_QUADS + row * 2;
  result[out_quad] = densityOf(ivec4(range[0].lowest, range[1].lowest, range[2].lowest, range[3].lowest));
  result[out_quad + 1] = densityOf(ivec4(range[4].lowest, range[5].lowest, range[6].lowest, range[7].lowest));
}
