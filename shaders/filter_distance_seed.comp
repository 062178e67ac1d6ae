// SPDX-License-Identifier: Apache-2.0
// shaders/filter_distance_seed.comp: finds each voxel's side of the isosurface and a first surface point. It tries the
// lines to the 26 neighbours within the domain. The nearest place where one of them crosses the isosurface is taken, if
// there is one. An invocation is a row of eight voxels.
#version 460
#extension GL_GOOGLE_include_directive : require
#include "filter.layout.h"
#include "filter_distance.layout.h"

layout(local_size_x = FILTER_GROUP) in;
layout(push_constant) uniform Push { FilterPush push; };
#include "filter.glsl"
#include "numbers.math.glsl"
#include "filter_distance.math.glsl"
#include "filter_row_ends.glsl"

const int kEnd = int(BRICK_EDGE);

void main() {
  const uint group = gl_WorkGroupID.y * GROUPS_PER_ROW + gl_WorkGroupID.x;
  if (group >= push.task_count) return;
  const FilterTask task = tasks[push.first_task + group];
  const uvec3 brick = brickOfIndex(task.brick);
  const uint row = gl_LocalInvocationID.x;
  const ivec3 last = ivec3(domainSize()) - 1;
  const ivec3 first = min(ivec3(brick * BRICK_EDGE + uvec3(0, row % BRICK_EDGE, row / BRICK_EDGE)), last);
  const float isovalue = taps[DISTANCE_ISOVALUE];
  const float edge_x = taps[DISTANCE_EDGE_SQUARE], edge_y = taps[DISTANCE_EDGE_SQUARE + 1];
  const float edge_z = taps[DISTANCE_EDGE_SQUARE + 2];

  float here[kRowWide], there[kRowWide];
  Crossing nearest[kEnd];
  READ_ROW(here, brick.x, uint(first.y), uint(first.z))
  for (int o = 0; o < kEnd; ++o) nearest[o] = noCrossing();
  for (int dz = -1; dz <= 1; ++dz) {
    for (int dy = -1; dy <= 1; ++dy) {
      const int y = first.y + dy, z = first.z + dz;
      const bool row_there = y >= 0 && y <= last.y && z >= 0 && z <= last.z;
      const uint read_y = uint(clamp(y, 0, last.y)), read_z = uint(clamp(z, 0, last.z));
      READ_ROW(there, brick.x, read_y, read_z)
      const float across = wayAcross(dy, dz, edge_y, edge_z);
      for (int dx = -1; dx <= 1; ++dx) {
        const float square = waySquare(dx, edge_x, across);
        const int way = (dz + 1) * 9 + (dy + 1) * 3 + dx + 1;
        for (int o = 0; o < kEnd; ++o) {
          const int x = first.x + o + dx;
          nearest[o] = nearerCrossing(nearest[o], here[o + 1], there[o + 1 + dx], isovalue, square, way,
                                      row_there && x >= 0 && x <= last.x);
        }
      }
    }
  }
  float words[kEnd];
  for (int o = 0; o < kEnd; ++o) {
    words[o] = uintBitsToFloat(seedWord(nearest[o], here[o + 1] > isovalue));
    if (o > 0 && first.x + o > last.x) words[o] = words[o - 1];
  }
  const uint out_quad = task.slot * BRICK_QUADS + row * 2;
  result[out_quad] = vec4(words[0], words[1], words[2], words[3]);
  result[out_quad + 1] = vec4(words[4], words[5], words[6], words[7]);
}
