// SPDX-License-Identifier: Apache-2.0
// shaders/cell_blocks.comp: which cells of a brick the isosurface crosses: those with a corner above the isovalue and
// one that is not. An invocation makes one block of 4x4x4 cells from its 5x5x5 voxels.
#version 460
#extension GL_GOOGLE_include_directive : require
#include "cell_tree.layout.h"

layout(local_size_x = CELL_BLOCKS_OF_BRICK) in;  // a work group is a brick
layout(push_constant) uniform Push { CellTreePush push; };
#define POOL_DOMAIN push.domain
#include "brick_pool.glsl"

layout(std430, binding = CELL_BINDING_BOUNDS) readonly buffer Bounds { BrickBounds bounds[]; };
layout(std430, binding = CELL_BINDING_TREE) readonly buffer Tree { uint tree[]; };
layout(std430, binding = CELL_BINDING_BLOCKS) writeonly buffer Blocks { uint blocks[]; };
layout(std430, binding = CELL_BINDING_LIST) readonly buffer List { uint list[]; };

// Bit i: voxel first + (i, 0, 0) is object, for i from 0 to 4. Voxels past the domain repeat the last one inside.
uint objectBits(uvec3 first, uvec3 brick) {
  const uvec3 at = min(first, domainSize() - 1);
  const BrickPage page = pages[brickIndex(uvec3(brick.x, at.yz / BRICK_EDGE))];
  uint bits = 0;
  if (page.slot == NO_SLOT) {
    bits = page.constant > push.isovalue ? 15u : 0u;
  } else {
    const vec4 quad = slabQuad(page.slot, ((at.z % BRICK_EDGE) * BRICK_EDGE + at.y % BRICK_EDGE) * 2 + (first.x % BRICK_EDGE) / 4);
    const uvec4 object = uvec4(greaterThan(quad, vec4(push.isovalue)));
    bits = object.x | object.y << 1 | object.z << 2 | object.w << 3;
  }
  const uint next = min(first.x + 4, domainSize().x - 1);
  return bits | uint(densityAt(uvec3(next, at.yz)) > push.isovalue) << 4;
}

void main() {
  const uint index = gl_WorkGroupID.y * GROUPS_PER_ROW + gl_WorkGroupID.x;
  if (index >= push.count) return;
  const uint linear = push.listed == 1 ? list[index] : index;
  const uint slot = tree[1 + linear];
  if (slot == NO_SLOT || !crosses(push.isovalue, bounds[linear])) return;
  const uvec3 brick = brickOfIndex(linear);
  const uint block = gl_LocalInvocationID.x;
  const uvec3 first = brick * BRICK_EDGE + CELL_BLOCK_EDGE * uvec3(block & 1, block >> 1 & 1, block >> 2);
  const uvec3 cells = domainSize() - 1;  // along each axis

  // Of two rows one above the other: where any and where all of four voxels around an edge along i are object.
  uint words[2] = {0, 0};
  uint any_below = 0, all_below = 0;
  for (uint z = 0; z <= CELL_BLOCK_EDGE; ++z) {
    uint any_here = 0, all_here = 0;  // five bits for each of four pairs of rows
    uint before = 0;
    for (uint y = 0; y <= CELL_BLOCK_EDGE; ++y) {
      const uint row = objectBits(first + uvec3(0, y, z), brick);
      if (y > 0) {
        any_here |= (row | before) << (5 * (y - 1));
        all_here |= (row & before) << (5 * (y - 1));
      }
      before = row;
    }
    if (z > 0) {
      for (uint y = 0; y < CELL_BLOCK_EDGE; ++y) {
        const uint any_of = (any_here | any_below) >> (5 * y) & 31u, all_of = (all_here & all_below) >> (5 * y) & 31u;
        uint crossed = (any_of | any_of >> 1) & ~(all_of & all_of >> 1) & 15u;
        const uvec3 cell = first + uvec3(0, y, z - 1);
        if (cell.y >= cells.y || cell.z >= cells.z) crossed = 0;
        if (cell.x + 4 > cells.x) crossed &= (1u << (cells.x - min(cell.x, cells.x))) - 1u;
        words[(z - 1) / 2] |= crossed << (16 * ((z - 1) % 2) + 4 * y);
      }
    }
    any_below = any_here;
    all_below = all_here;
  }
  blocks[slot * CELL_WORDS_OF_BRICK + 2 * block] = words[0];
  blocks[slot * CELL_WORDS_OF_BRICK + 2 * block + 1] = words[1];
}
