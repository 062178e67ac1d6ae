// SPDX-License-Identifier: Apache-2.0
// shaders/cell_tree.layout.h: which cells an isosurface crosses, as a tree of bit masks. A ray that looks into it
// leaves empty space in large steps.
//
// Cell (i, j, k) lies between voxel (i, j, k) and its seven neighbours along +i, +j and +k. A block is 4x4x4 cells: 64
// bits, set where the isosurface crosses the cell. Blocks are stored for the bricks that the isosurface crosses only. A
// node of level 1 has a bit for each of 4x4x4 bricks, a node of a higher level one for each of 4x4x4 nodes below it.
// Bit number: (z * 4 + y) * 4 + x, the lower 32 in the first word.
#ifndef PALPATE_CELL_TREE_LAYOUT_H
#define PALPATE_CELL_TREE_LAYOUT_H
#include "brick_pool.layout.h"

#define CELL_BLOCK_EDGE 4
#define CELL_BLOCKS_OF_BRICK 8
#define CELL_WORDS_OF_BRICK 16  // its blocks, two words each
#define CELL_NODE_EDGE 4
#define CELL_TREE_LEVELS 3  // at most: a node of the third is 512 voxels long
#define CELL_GROUP 8

#define CELL_BINDING_BOUNDS BINDING_OWN
#define CELL_BINDING_TREE (BINDING_OWN + 1)
#define CELL_BINDING_BLOCKS (BINDING_OWN + 2)
#define CELL_BINDING_LIST (BINDING_OWN + 3)
#define CELL_BINDINGS (BINDING_OWN + 4)

PALPATE_LAYOUT_BEGIN

// The tree buffer: one word that counts slots, one for each brick (its slot among the blocks, or NO_SLOT), then the
// nodes, level by level.
struct CellTreePush {
  PoolDomain domain;
  float isovalue;                  // [density]
  uint count;                      // bricks of the list, or nodes along x, y and z of the box
  uint listed;                     // 1: the list's bricks; 0: all bricks
  uint level;                      // of the nodes that are made
  uint first_x, first_y, first_z;  // node where the box begins
  uint size_x, size_y, size_z;     // of the box [node]
};

// Nodes along an axis at a level, and the word where a level begins.
PALPATE_TEXT uint cellNodesAlong(uint bricks, uint level) {
  const uint shift = 2u * level;
  return (bricks + (1u << shift) - 1u) >> shift;
}
PALPATE_TEXT uint cellNodesOfLevel(PoolDomain domain, uint level) {
  return cellNodesAlong(domain.bricks_x, level) * cellNodesAlong(domain.bricks_y, level) *
         cellNodesAlong(domain.bricks_z, level);
}
PALPATE_TEXT uint cellLevelBegin(PoolDomain domain, uint level) {
  uint begin = 1u + domain.bricks_x * domain.bricks_y * domain.bricks_z;
  for (uint below = 1u; below < level; ++below) begin += 2u * cellNodesOfLevel(domain, below);
  return begin;
}

PALPATE_LAYOUT_CHECK(CellTreePush, 64)
PALPATE_PUSH_CHECK(CellTreePush)

PALPATE_LAYOUT_END
#endif
