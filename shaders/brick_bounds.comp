// SPDX-License-Identifier: Apache-2.0
// shaders/brick_bounds.comp: lowest and highest density of every brick, over all cells whose first corner lies in the
// brick. These cells cover 9x9x9 voxels. One invocation walks a brick: no shared memory, no barrier.
#version 460
#extension GL_GOOGLE_include_directive : require
#include "brick_bounds.layout.h"

layout(local_size_x_id = 1) in;
layout(push_constant) uniform Push { BoundsPush push; };
#define POOL_DOMAIN push.domain
#include "brick_pool.glsl"

layout(std430, binding = BOUNDS_BINDING_BOUNDS) writeonly buffer Bounds { BrickBounds bounds[]; };
layout(std430, binding = BOUNDS_BINDING_TASKS) readonly buffer Tasks { BrickTask tasks[]; };
layout(std430, binding = BOUNDS_BINDING_RESULTS) writeonly buffer Results { BrickBounds results[]; };

void widen(inout float lowest, inout float highest, vec4 quad) {
  lowest = min(lowest, min(min(quad.x, quad.y), min(quad.z, quad.w)));
  highest = max(highest, max(max(quad.x, quad.y), max(quad.z, quad.w)));
}

// If a brick holds one value and its neighbours hold one each, its cells have eight values at most.
bool constantBounds(uvec3 brick, uvec3 end, out BrickBounds found) {
  const uvec3 last = end / BRICK_EDGE;
  found = BrickBounds(0, 0);
  for (uint z = brick.z; z <= last.z; ++z) {
    for (uint y = brick.y; y <= last.y; ++y) {
      for (uint x = brick.x; x <= last.x; ++x) {
        const BrickPage page = pages[brickIndex(uvec3(x, y, z))];
        if (page.slot != NO_SLOT) return false;
        const bool first = all(equal(uvec3(x, y, z), brick));
        found.lowest = first ? page.constant : min(found.lowest, page.constant);
        found.highest = first ? page.constant : max(found.highest, page.constant);
      }
    }
  }
  return true;
}

BrickBounds boundsOf(uvec3 brick) {
  const uvec3 first = brick * BRICK_EDGE;
  const uvec3 end = min(first + BRICK_EDGE, domainSize() - 1);  // the last voxel of the last cell, inclusive
  BrickBounds found;
  if (constantBounds(brick, end, found)) return found;

  const bool has_next = first.x + BRICK_EDGE <= domainSize().x - 1;
  float lowest = densityAt(first);
  float highest = lowest;
  for (uint z = first.z; z <= end.z; ++z) {
    for (uint y = first.y; y <= end.y; ++y) {
      // Voxels past the domain repeat the last one inside, so whole rows may be read.
      const uvec3 at = uvec3(brick.x, y / BRICK_EDGE, z / BRICK_EDGE);
      const Row row = pageRow(pages[brickIndex(at)], y % BRICK_EDGE, z % BRICK_EDGE);
      widen(lowest, highest, row.low);
      widen(lowest, highest, row.high);
      if (has_next) widen(lowest, highest, vec4(densityAt(uvec3(first.x + BRICK_EDGE, y, z))));
    }
  }
  return BrickBounds(lowest, highest);
}

void main() {
  const uint index = (gl_WorkGroupID.y * GROUPS_PER_ROW + gl_WorkGroupID.x) * gl_WorkGroupSize.x + gl_LocalInvocationID.x;
  if (index >= push.brick_count) return;
  const uint brick = push.listed == 1 ? tasks[index].brick : index;
  BrickBounds found = boundsOf(brickOfIndex(brick));
  // The order of the voxels would decide between -0 and +0. Bounds that are updated must equal those of a new run, so
  // +0 stands for both.
  if (found.lowest == 0.0) found.lowest = 0.0;
  if (found.highest == 0.0) found.highest = 0.0;
  bounds[brick] = found;
  if (push.listed == 1) results[index] = found;
}
