// SPDX-License-Identifier: Apache-2.0
// shaders/filter_distance_finish.comp: signed distance in the place of the word of the surface point that a voxel knows:
// reads the densities, rewrites the result. From that point the voxel is projected onto the trilinear field's tangent
// plane, and again at the place where it came to lie, as long as that brings the normal nearer to the voxel; the
// distance is that from the last plane. An invocation is a row of eight voxels.
#version 460
#extension GL_GOOGLE_include_directive : require
#include "filter.layout.h"
#include "filter_distance.layout.h"

layout(local_size_x = FILTER_GROUP) in;
layout(push_constant) uniform Push { FilterPush push; };
#define FILTER_RESULT_ACCESS
#include "filter.glsl"
#include "filter_distance.math.glsl"

const int kProjections = 2;  // of the voxel, each onto the tangent plane at the last one's place

// One density of a brick. Loads are what this kernel costs, so pages are read no more than needed (a branch saves the
// loads of those that do not take it), and of a quad its one element.
float densityIn(uint page, uint slot, uint at) {
  if (slot == NO_SLOT) return pages[page].constant;
  if (kSlabCount == 1) return slab0[slot * BRICK_QUADS + at / 4][at % 4];
  return slabQuad(slot, at / 4)[at % 4];
}

uint placeInBrick(uint x, uint y, uint z) {
  return ((z % BRICK_EDGE) * BRICK_EDGE + y % BRICK_EDGE) * BRICK_EDGE + x % BRICK_EDGE;
}

// A cell's corner, 0 or 1 from its first along each axis; slot: of the page that holds the first.
float corner(uvec3 cell, uint first_page, uint slot, uint dx, uint dy, uint dz) {
  const uvec3 at = cell + uvec3(dx, dy, dz);
  const uint page = brickIndex(at / BRICK_EDGE);
  if (page != first_page) slot = pages[page].slot;
  return densityIn(page, slot, placeInBrick(at.x, at.y, at.z));
}

// Gradient and value `shift` voxels from a voxel, within the domain. A point on the domain's last voxel belongs to the
// cell before it, and a domain of one voxel is half a cell: what lies behind it repeats it.
vec4 fieldAt(ivec3 voxel, vec3 shift) {
  const ivec3 size = ivec3(domainSize());
  uvec3 cell;
  vec3 share;
  for (int axis = 0; axis < 3; ++axis) {
    const float whole = floor(shift[axis]);
    precise float rest = shift[axis] - whole;
    const int c = voxel[axis] + int(whole);
    const bool at_end = c >= size[axis] - 1;
    cell[axis] = uint(at_end ? max(size[axis] - 2, 0) : c);
    share[axis] = at_end ? 1.0f : rest;
  }
  const uint page = brickIndex(cell / BRICK_EDGE);
  const uint slot = pages[page].slot;
  const vec4 low = vec4(corner(cell, page, slot, 0, 0, 0), corner(cell, page, slot, 1, 0, 0),
                        corner(cell, page, slot, 0, 1, 0), corner(cell, page, slot, 1, 1, 0));
  const vec4 high = vec4(corner(cell, page, slot, 0, 0, 1), corner(cell, page, slot, 1, 0, 1),
                         corner(cell, page, slot, 0, 1, 1), corner(cell, page, slot, 1, 1, 1));
  return fieldIn(low, high, share.x, share.y, share.z);
}

// The step's numbers, read once.
float isovalue, band, unit, slack;
vec4 edge;

float distanceOf(ivec3 voxel, float density, uint word) {
  const bool inside = density > isovalue;
  float distance = band;
  // A loop of one round, since lavapipe goes through a branch that no invocation takes, but not through such a loop.
  for (uint known = min(word, 1u); known > 0; --known) {
    const vec3 foot = vec3(offsetOf(word, 0), offsetOf(word, 1), offsetOf(word, 2)) * (1.0f / float(DISTANCE_PARTS));
    precise float away_x = -foot.x * edge[0];
    precise float away_y = -foot.y * edge[1];
    precise float away_z = -foot.z * edge[2];
    float away_square = awaySquare(away_x, away_y, away_z);
    vec4 field = fieldAt(voxel, foot);
    vec4 normal = normalOf(field, edge);
    float left = leftOf(field[3], isovalue, normal[3]);
    left = left > DISTANCE_LEFT ? DISTANCE_LEFT : left;
    left = left < -DISTANCE_LEFT ? -DISTANCE_LEFT : left;
    float rise = riseOf(normal, away_x, away_y, away_z, left);
    float height = inside ? rise : -rise;
    float side = sideOf(away_square, height);
    bool nearer = true;
    for (int projection = 0; projection < kProjections && nearer; ++projection) {
      precise float to_x = rise * normal[0];
      precise float to_y = rise * normal[1];
      precise float to_z = rise * normal[2];
      precise float shift_x = -to_x / edge[0];
      precise float shift_y = -to_y / edge[1];
      precise float shift_z = -to_z / edge[2];
      const vec3 shift = vec3(shift_x, shift_y, shift_z), place = vec3(voxel), last = vec3(domainSize()) - 1;
      const bool possible = height >= 0.0f && height < band + 1.0f && all(greaterThanEqual(shift, -place)) &&
                            all(lessThanEqual(shift, last - place));
      field = fieldAt(voxel, possible ? shift : vec3(0));
      const vec4 new_normal = normalOf(field, edge);
      left = leftOf(field[3], isovalue, new_normal[3]);
      const float new_rise = riseOf(new_normal, to_x, to_y, to_z, left);
      const float new_height = inside ? new_rise : -new_rise;
      const float new_square = awaySquare(to_x, to_y, to_z);
      const float new_side = sideOf(new_square, new_height);
      nearer = possible && abs(left) <= DISTANCE_LEFT && new_height >= 0.0f &&
               (new_side < side || new_side <= slack);
      if (nearer) {
        normal = new_normal;
        rise = new_rise;
        height = new_height;
        side = new_side;
        away_square = new_square;
      }
    }
    const float found = distanceOver(height, side, slack, away_square);
    distance = found < band ? found : band;
  }
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
  edge = vec4(taps[DISTANCE_EDGE], taps[DISTANCE_EDGE + 1], taps[DISTANCE_EDGE + 2], 0);
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
