// SPDX-License-Identifier: Apache-2.0
// shaders/brick_pool.layout.h: the volume on the GPU: bricks of 8x8x8 densities behind a page table.
//
// Vulkan guarantees only 128 MiB for a storage buffer binding, so the pool is bound in slabs of that size. A brick's 64
// rows of eight voxels along i are stored one after another, each as two vec4; row = z * 8 + y.
#ifndef PALPATE_BRICK_POOL_LAYOUT_H
#define PALPATE_BRICK_POOL_LAYOUT_H
#include "layout_types.h"

#define BRICK_EDGE 8                    // voxels along an edge
#define BRICK_ROWS 64                   // rows of 8 voxels along i; also the invocations that share a brick
#define BRICK_QUADS 128                 // vec4 in a brick
#define NO_SLOT 0xffffffffu             // in place of a slot: the brick has no storage
#define DENSITY_SLABS 8                 // bound at once: 8 x 128 MiB = 1 GiB of density
#define BRICKS_PER_DENSITY_SLAB 65536u  // x 2 KiB = 128 MiB
#define BRICKS_PER_SAMPLE_SLAB 16384u   // x 8 KiB = 128 MiB: bricks of samples as floats; as halves, twice as many
// Flag in BrickTask.sample_slot. The kernel then decides by the brick's bounds whether the isosurface needs its
// samples.
#define IF_ACTIVE 0x80000000u
#define GROUPS_PER_ROW 32768u  // Vulkan guarantees 65535 groups along x; longer lists are folded

// Bindings of every kernel that reads the pool. A kernel's own buffers follow from BINDING_OWN on.
#define BINDING_PAGES 0
#define BINDING_SLABS 1
#define BINDING_OWN 9  // BINDING_SLABS + DENSITY_SLABS

PALPATE_LAYOUT_BEGIN

struct BrickPage {
  uint slot;       // where the brick is in the pool, or NO_SLOT
  float constant;  // density of the whole brick if it has no slot
};

// The domain, pushed to every kernel that reads the pool.
struct PoolDomain {
  uint size_x, size_y, size_z;        // [voxel]
  uint bricks_x, bricks_y, bricks_z;  // page table dimensions
};

// A brick to work on and where its samples go or come from.
struct BrickTask {
  uint brick;        // linear page index
  uint sample_slot;  // slot within the bound sample slab, perhaps with IF_ACTIVE, or NO_SLOT
};

struct BrickBounds {
  float lowest, highest;  // over the voxels of all cells whose first corner lies in the brick [density]
};

// The isovalues whose isosurfaces need samples. Normally one, given twice; two while the servo goes over to another.
struct IsovaluePair {
  float felt, other;  // [density]
};

// Whether an isosurface crosses cells with these bounds. Density above the isovalue is object, at or below it
// background.
PALPATE_TEXT bool crosses(float isovalue, BrickBounds bounds) {
  return bounds.lowest <= isovalue && bounds.highest > isovalue;
}
PALPATE_TEXT bool eitherCrosses(IsovaluePair isovalues, BrickBounds bounds) {
  return crosses(isovalues.felt, bounds) || crosses(isovalues.other, bounds);
}

PALPATE_LAYOUT_CHECK(BrickPage, 8)
PALPATE_LAYOUT_CHECK(PoolDomain, 24)
PALPATE_LAYOUT_CHECK(BrickTask, 8)
PALPATE_LAYOUT_CHECK(BrickBounds, 8)
PALPATE_LAYOUT_CHECK(IsovaluePair, 8)

PALPATE_LAYOUT_END
#endif
