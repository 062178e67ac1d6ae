// SPDX-License-Identifier: Apache-2.0
// shaders/brick_bounds.comp: lowest and highest density of every brick, over all cells whose first corner lies in it, that
// is over 9x9x9 voxels. One invocation walks a brick: no shared memory, no barrier.
#version 460
#extension GL_GOOGLE_include_directive : require
#include "brick_bounds.layout.h"

layout(local_size_x = BOUNDS_GROUP) in;
layout(push_constant) uniform Push { BoundsPush push; };
#define POOL_DOMAIN push.domain
#include "brick_pool.glsl"

layout(std430, binding = BOUNDS_BINDING_BOUNDS) writeonly buffer Bounds { BrickBounds bounds[]; };

void widen(inout float lowest, inout float highest, vec4 quad) {
  lowest = min(lowest, min(min(quad.x, quad.y), min(quad.z, quad.w)));
  highest = max(highest, max(max(quad.x, quad.y), max(quad.z, quad.w)));
}

void main() {
  const uint index = (gl_WorkGroupID.y * GROUPS_PER_ROW + gl_WorkGroupID.x) * BOUNDS_GROUP + gl_LocalInvocationID.x;
  if (index >= push.brick_count) return;
  const uvec3 brick = brickOfIndex(index);
  const uvec3 first = brick * BRICK_EDGE;
  const uvec3 end = min(first + BRICK_EDGE, domainSize() - 1);  // the last voxel of the last cell, inclusive
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
  bounds[index] = BrickBounds(lowest, highest);
}
