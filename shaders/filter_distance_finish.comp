// SPDX-License-Identifier: Apache-2.0
// shaders/filter_distance_finish.comp: replaces each voxel's word by the signed distance. It reads the densities and
// rewrites the result.
//
// The voxel is projected onto the tangent plane of the trilinear field at the surface point that its word holds. It is
// projected again at the place where it landed, as long as that brings the normal nearer to the voxel. The distance is
// that from the last plane, within the bounds that the nearest voxel across sets. An invocation is a row of eight
// voxels.
#version 460
#extension GL_GOOGLE_include_directive : require
#include "filter.layout.h"
#include "filter_distance.layout.h"

layout(local_size_x = FILTER_GROUP) in;
layout(push_constant) uniform Push { FilterPush push; };
#define FILTER_RESULT_ACCESS
#include "filter.glsl"
#include "numbers.math.glsl"
#include "filter_distance.math.glsl"

const int kProjections = 2;  // repeated projections, each onto the tangent plane where the last one landed

// One density of a brick. Loads are what this kernel costs. So pages are read only where needed, and only one element
// of a quad. (A branch saves the loads of invocations that do not take it.)
float densityIn(uint page, uint slot, uint at) {
  if (slot == NO_SLOT) return pages[page].constant;
  if (kSlabCount == 1) return slab0[slot * BRICK_QUADS + at / 4][at % 4];
  return slabQuad(slot, at / 4)[at % 4];
}

uint placeInBrick(uint x, uint y, uint z) {
  return ((z % BRICK_EDGE) * BRICK_EDGE + y % BRICK_EDGE) * BRICK_EDGE + x % BRICK_EDGE;
}

// A cell's corner, 0 or 1 from its first corner along each axis. `slot`: of the page that holds the first corner.
float corner(uvec3 cell, uint first_page, uint slot, uint dx, uint dy, uint dz) {
  const uvec3 at = cell + uvec3(dx, dy, dz);
  const uint page = brickIndex(at / BRICK_EDGE);
  if (page != first_page) slot = pages[page].slot;
  return densityIn(page, slot, placeInBrick(at.x, at.y, at.z));
}

// The field for filter_distance.math.glsl, at a place `shift` voxels from a voxel, within the domain.
vec4 fieldAt(ivec3 voxel, vec4 shift) {
  const ivec3 size = ivec3(domainSize());
  const CellPlace x = cellAt(voxel.x, shift[0], size.x), y = cellAt(voxel.y, shift[1], size.y);
  const CellPlace z = cellAt(voxel.z, shift[2], size.z);
  const uvec3 cell = uvec3(x.cell, y.cell, z.cell);
  const uint page = brickIndex(cell / BRICK_EDGE);
  const uint slot = pages[page].slot;
  const vec4 low = vec4(corner(cell, page, slot, 0, 0, 0), corner(cell, page, slot, 1, 0, 0),
                        corner(cell, page, slot, 0, 1, 0), corner(cell, page, slot, 1, 1, 0));
  const vec4 high = vec4(corner(cell, page, slot, 0, 0, 1), corner(cell, page, slot, 1, 0, 1),
                         corner(cell, page, slot, 0, 1, 1), corner(cell, page, slot, 1, 1, 1));
  return fieldIn(low, high, x.share, y.share, z.share);
}

// The filter step's numbers, read once.
float isovalue, band, unit, slack;
vec4 edge, edge_square;

float distanceOf(ivec3 voxel, float density, uint word) {
  const bool inside = density > isovalue;
  const ivec3 size = ivec3(domainSize());
  float distance = band, point = band;
  // A loop of one round. lavapipe executes a branch that no invocation takes, but not such a loop.
  for (uint known = min(word & DISTANCE_POINT, 1u); known > 0; --known) {
    const vec4 foot = pointShift(word);
    Tangent tangent = tangentOf(fieldAt(voxel, foot), edge, isovalue, awayFrom(foot, edge), inside, true);
    point = sqrt(tangent.away_square);
    bool better = true;
    for (int projection = 0; projection < kProjections && better; ++projection) {
      const vec4 away = risenBy(tangent);
      const vec4 shift = landingShift(away, edge);
      const bool possible = isOver(tangent, band) && isWithin(shift[0], voxel.x, size.x) &&
                            isWithin(shift[1], voxel.y, size.y) && isWithin(shift[2], voxel.z, size.z);
      const vec4 field = fieldAt(voxel, possible ? shift : vec4(0));
      const Tangent landed = tangentOf(field, edge, isovalue, away, inside, false);
      better = possible && isBetter(landed, tangent, slack);
      if (better) tangent = landed;
    }
    distance = distanceOver(tangent, slack);
  }
  distance = heldDistance(distance, point, word, acrossSquare(word, edge_square[0], edge_square[1], edge_square[2]),
                          slack, band);
  return signedDistance(distance, unit, inside);
}

void main() {
  const uint group = gl_WorkGroupID.y * GROUPS_PER_ROW + gl_WorkGroupID.x;
  if (group >= push.task_count) return;
  const FilterTask task = tasks[push.first_task + group];
  const uvec3 brick = brickOfIndex(task.brick);
  const uint row = gl_LocalInvocationID.x;
  const ivec3 last = ivec3(domainSize()) - 1;
  const ivec3 first = min(ivec3(brick * BRICK_EDGE + uvec3(0, row % BRICK_EDGE, row / BRICK_EDGE)), last);
  const uint out_quad = task.slot * BRICK_QUADS + row * 2;
  const uint slot = pages[task.brick].slot;
  isovalue = taps[DISTANCE_ISOVALUE];
  band = taps[DISTANCE_BAND];
  unit = taps[DISTANCE_UNIT];
  slack = taps[DISTANCE_SLACK];
  edge = vec4(taps[DISTANCE_EDGE], taps[DISTANCE_EDGE + 1], taps[DISTANCE_EDGE + 2], 1);
  edge_square = vec4(taps[DISTANCE_EDGE_SQUARE], taps[DISTANCE_EDGE_SQUARE + 1], taps[DISTANCE_EDGE_SQUARE + 2], 1);
  for (int q = 0; q < 2; ++q) {
    const vec4 words = result[out_quad + q];
    vec4 distances;
    for (int t = 0; t < 4; ++t) {
      const ivec3 voxel = ivec3(min(first.x + 4 * q + t, last.x), first.yz);
      const float density = densityIn(task.brick, slot, placeInBrick(uint(voxel.x), uint(voxel.y), uint(voxel.z)));
      distances[t] = distanceOf(voxel, density, floatBitsToUint(words[t]));
    }
    result[out_quad + q] = distances;
  }
}
