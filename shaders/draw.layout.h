// SPDX-License-Identifier: Apache-2.0
// shaders/draw.layout.h: push constants, bindings and constants of the kernel that draws the isosurface.
#ifndef PALPATE_DRAW_LAYOUT_H
#define PALPATE_DRAW_LAYOUT_H
#include "brick_pool.layout.h"
#include "picture.layout.h"

#define DRAW_BINDING_TREE BINDING_OWN              // cell tree of the isosurface (cell_tree.layout.h)
#define DRAW_BINDING_BLOCKS (BINDING_OWN + 1)      // and its blocks
#define DRAW_BINDING_OTHER_TREE (BINDING_OWN + 2)  // the same of the second isosurface
#define DRAW_BINDING_OTHER_BLOCKS (BINDING_OWN + 3)
#define DRAW_BINDING_TILES (BINDING_OWN + 4)  // x | y << 16 of each tile
#define DRAW_BINDING_EXTRAS (BINDING_OWN + 5)
#define DRAW_BINDING_PIXELS (BINDING_OWN + 6)
#define DRAW_BINDINGS (BINDING_OWN + 7)

// Specialisation constants. What a picture does not ask for is not in its kernel.
#define DRAW_CONSTANT_LEVELS 1     // of the cell trees
#define DRAW_CONSTANT_CLIPS 2      // number of clipping planes
#define DRAW_CONSTANT_SLICES 3     // number of slice planes
#define DRAW_CONSTANT_OTHER 4      // 1: there is a second isosurface
#define DRAW_CONSTANT_OCCLUSION 5  // 1: ambient occlusion
#define DRAW_CONSTANT_NORMALS 6    // 1: the colour is the normal

#define DRAW_TILE 8  // pixels along a side of a tile, which is a work group
// How far from a changed voxel a picture may change [voxel]: a normal's differences reach two voxels from the cell that
// is hit; occlusion looks up to six voxels from the point, into the next cell.
#define DRAW_NORMAL_REACH 2
#define DRAW_OCCLUSION_REACH 8
#define DRAW_MOST_CLIPS 6
#define DRAW_MOST_SLICES 3
// Steps of the search for the root in a cell: of 42,000 random cells eight leave 1 in 100 more than 2e-7 of the way
// off, 1 in 1,000 more than 5e-6, and the worst 1.2e-3.
#define DRAW_ROOT_STEPS 8

PALPATE_LAYOUT_BEGIN

struct DrawPush {
  PoolDomain domain;
  uint size;       // width | height << 16 [pixel]
  float isovalue;  // [density]
  PictureRays rays;
  uint first_tile, tile_count;  // of the list of tiles
  // Of the pixels of a tile: every `stride`-th of the picture along x and y, beginning at (x, y), each written to a
  // square of `square` pixels. stride | x << 8 | y << 16 | square << 24
  uint grid;
};

// n . p + d for a point p of the lattice [voxel].
struct DrawPlane {
  float x, y, z, d;
};

struct DrawExtras {
  DrawPlane clips[DRAW_MOST_CLIPS];    // kept is where the value is not below 0
  DrawPlane slices[DRAW_MOST_SLICES];  // the density is shown where the value is 0
  float slice_black, slice_white;      // [density]
  float other_isovalue;                // [density]
  float other_opacity;                 // 0 to 1
};

PALPATE_LAYOUT_CHECK(DrawPush, 104)
PALPATE_PUSH_CHECK(DrawPush)
PALPATE_LAYOUT_CHECK(DrawPlane, 16)
PALPATE_LAYOUT_CHECK(DrawExtras, 160)

PALPATE_LAYOUT_END
#endif
