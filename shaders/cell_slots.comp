// SPDX-License-Identifier: Apache-2.0
// shaders/cell_slots.comp: gives a slot for its blocks to each brick that the isosurface crosses and that has none. A
// brick keeps its slot: the nodes above it say whether the isosurface still crosses it.
#version 460
#extension GL_GOOGLE_include_directive : require
#include "cell_tree.layout.h"

layout(local_size_x = CELL_GROUP) in;
layout(push_constant) uniform Push { CellTreePush push; };
#define POOL_DOMAIN push.domain
#include "brick_pool.glsl"

layout(std430, binding = CELL_BINDING_BOUNDS) readonly buffer Bounds { BrickBounds bounds[]; };
layout(std430, binding = CELL_BINDING_TREE) buffer Tree { uint tree[]; };
layout(std430, binding = CELL_BINDING_LIST) readonly buffer List { uint list[]; };

void main() {
  const uint index = (gl_WorkGroupID.y * GROUPS_PER_ROW + gl_WorkGroupID.x) * CELL_GROUP + gl_LocalInvocationID.x;
  if (index >= push.count) return;
  const uint brick = push.listed == 1 ? list[index] : index;
  if (tree[1 + brick] == NO_SLOT && crosses(push.isovalue, bounds[brick])) tree[1 + brick] = atomicAdd(tree[0], 1);
}
