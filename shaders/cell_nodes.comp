// SPDX-License-Identifier: Apache-2.0
// shaders/cell_nodes.comp: the nodes of one level of the tree, in a box of nodes. Level 1 is made from the bounds of
// bricks, a higher level from the one below it.
#version 460
#extension GL_GOOGLE_include_directive : require
#include "cell_tree.layout.h"

layout(local_size_x = CELL_GROUP) in;
layout(push_constant) uniform Push { CellTreePush push; };
#define POOL_DOMAIN push.domain
#include "brick_pool.glsl"

layout(std430, binding = CELL_BINDING_BOUNDS) readonly buffer Bounds { BrickBounds bounds[]; };
layout(std430, binding = CELL_BINDING_TREE) buffer Tree { uint tree[]; };

uvec3 nodesOfLevel(uint level) {
  return uvec3(cellNodesAlong(push.domain.bricks_x, level), cellNodesAlong(push.domain.bricks_y, level),
               cellNodesAlong(push.domain.bricks_z, level));
}

uint linear(uvec3 at, uvec3 counts) { return (at.z * counts.y + at.y) * counts.x + at.x; }

void main() {
  const uint index = (gl_WorkGroupID.y * GROUPS_PER_ROW + gl_WorkGroupID.x) * CELL_GROUP + gl_LocalInvocationID.x;
  if (index >= push.count) return;
  const uvec3 size = uvec3(push.size_x, push.size_y, push.size_z);
  const uvec3 node =
      uvec3(push.first_x, push.first_y, push.first_z) + uvec3(index % size.x, index / size.x % size.y, index / (size.x * size.y));
  const uvec3 below = nodesOfLevel(push.level - 1);
  const uint below_begin = cellLevelBegin(push.domain, push.level - 1);
  uint words[2] = {0, 0};
  for (uint bit = 0; bit < 64; ++bit) {
    const uvec3 child = node * CELL_NODE_EDGE + uvec3(bit & 3, bit >> 2 & 3, bit >> 4);
    if (any(greaterThanEqual(child, below))) continue;
    const uint at = linear(child, below);
    bool crossed;
    if (push.level == 1) {
      crossed = crosses(push.isovalue, bounds[at]);
    } else {
      crossed = (tree[below_begin + 2 * at] | tree[below_begin + 2 * at + 1]) != 0;
    }
    if (crossed) words[bit >> 5] |= 1u << (bit & 31);
  }
  const uint word = cellLevelBegin(push.domain, push.level) + 2 * linear(node, nodesOfLevel(push.level));
  tree[word] = words[0];
  tree[word + 1] = words[1];
}
