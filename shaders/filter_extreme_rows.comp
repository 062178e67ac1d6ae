// SPDX-License-Identifier: Apache-2.0
// shaders/filter_extreme_rows.comp: highest or lowest density within a shape that is made of rows along i, such as a
// ball. Each row reaches as far to either side of its middle. An invocation computes a row of eight results.
//
// A row that reaches h to either side gives each result the extreme of 2 h + 1 voxels. Rows go from the longest to the
// shortest. At each step down in h, the extreme so far is widened by one voxel. So each row costs its loads and no
// more. `taps` holds, for each h from 0 on, how many rows are shorter than h, with one more entry for the end. Then it
// holds each row's (dj, dk).
#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_control_flow_attributes : require
#include "filter.layout.h"

layout(local_size_x = FILTER_GROUP) in;
layout(push_constant) uniform Push { FilterPush push; };
#include "filter.glsl"
#include "filter_extreme.glsl"
#include "filter_rows.glsl"

layout(constant_id = FILTER_CONSTANT_OWN + 1) const int kReach = 1;  // along i
const int kEnd = int(BRICK_EDGE);
const int kRing = (kReach + 7) / 8;
const int kWide = kEnd + 2 * kReach;

int seen[kWide];  // from kReach voxels before the row to kReach behind it

#define SEE(at, rank) seen[(at) + kReach] = extreme(seen[(at) + kReach], rank);

void seeRow(uvec3 brick, uint row, int dj, int dk) {
  const RowPlace place = rowPlace(brick, row, dj, dk);
  if (kEdge == 0) {
    [[unroll]] for (int b = -kRing; b <= kRing; ++b) {
      const BrickPage page = pages[uint(int(place.page) + b)];
      [[unroll]] for (int q = 0; q < 2; ++q) {
        const int first = kEnd * b + 4 * q;
        if (first >= -kReach && first + 3 < kEnd + kReach) {
          const ivec4 quad = rankOf(pageQuad(page, place.quad + q));
          [[unroll]] for (int t = 0; t < 4; ++t) { SEE(first + t, quad[t]) }
        } else {
          [[unroll]] for (int t = 0; t < 4; ++t) {
            if (first + t >= -kReach && first + t < kEnd + kReach) {
              SEE(first + t, rankOf(pageDensity(page, place.quad + q, t)))
            }
          }
        }
      }
    }
  } else {
    [[unroll]] for (int at = -kReach; at < kEnd + kReach; ++at) { SEE(at, rankOf(besideRow(place, brick, at))) }
  }
}

void widen() {
  int before = nothing();
  for (int x = 0; x < kWide; ++x) {
    const int own = seen[x];
    seen[x] = extreme(extreme(before, own), x + 1 < kWide ? seen[min(x + 1, kWide - 1)] : nothing());
    before = own;
  }
}

void main() {
  const uint task_index = gl_WorkGroupID.y * GROUPS_PER_ROW + gl_WorkGroupID.x;
  if (task_index >= push.task_count) return;
  const FilterTask task = tasks[push.first_task + task_index];
  const uvec3 brick = brickOfIndex(task.brick);
  const uint row = gl_LocalInvocationID.x;
  for (int x = 0; x < kWide; ++x) seen[x] = nothing();
  int end = int(taps[kReach + 1]);
  for (int h = kReach; h >= 0; --h) {
    widen();
    const int begin = int(taps[h]);
    for (int n = begin; n < end; ++n) {
      seeRow(brick, row, int(taps[kReach + 2 + 2 * n]), int(taps[kReach + 3 + 2 * n]));
    }
    end = begin;
  }
  int found[kEnd];
  [[unroll]] for (int i = 0; i < kEnd; ++i) found[i] = seen[i + kReach];
  if (kEdge != 0) {
    const int last = int(domainSize().x) - 1 - int(brick.x * BRICK_EDGE);
    [[unroll]] for (int i = 1; i < kEnd; ++i) found[i] = i > last ? found[i - 1] : found[i];
  }
  const uint out_quad = task.slot * BRICK_QUADS + row * 2;
  result[out_quad] = densityOf(ivec4(found[0], found[1], found[2], found[3]));
  result[out_quad + 1] = densityOf(ivec4(found[4], found[5], found[6], found[7]));
}
