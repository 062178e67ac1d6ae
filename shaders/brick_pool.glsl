// SPDX-License-Identifier: Apache-2.0
// shaders/brick_pool.glsl: reads the brick pool. Include after the push constant that holds `PoolDomain`, with
// POOL_DOMAIN defined as that member.
#include "brick_pool.layout.h"

// Number of slabs that the volume uses. As a constant it removes the choice among the others; lavapipe would take every
// branch of that choice. Each kernel is built a second time for one slab, which most volumes need: there the choice is
// not even in the code, which a driver then reads in half the time.
#ifdef ONE_SLAB
const uint kSlabCount = 1;
#else
layout(constant_id = 0) const uint kSlabCount = 1;
#endif

layout(std430, binding = BINDING_PAGES) readonly buffer Pages { BrickPage pages[]; };
layout(std430, binding = BINDING_SLABS + 0) readonly buffer Slab0 { vec4 slab0[]; };
layout(std430, binding = BINDING_SLABS + 1) readonly buffer Slab1 { vec4 slab1[]; };
layout(std430, binding = BINDING_SLABS + 2) readonly buffer Slab2 { vec4 slab2[]; };
layout(std430, binding = BINDING_SLABS + 3) readonly buffer Slab3 { vec4 slab3[]; };
layout(std430, binding = BINDING_SLABS + 4) readonly buffer Slab4 { vec4 slab4[]; };
layout(std430, binding = BINDING_SLABS + 5) readonly buffer Slab5 { vec4 slab5[]; };
layout(std430, binding = BINDING_SLABS + 6) readonly buffer Slab6 { vec4 slab6[]; };
layout(std430, binding = BINDING_SLABS + 7) readonly buffer Slab7 { vec4 slab7[]; };

uvec3 domainSize() { return uvec3(POOL_DOMAIN.size_x, POOL_DOMAIN.size_y, POOL_DOMAIN.size_z); }

uint brickIndex(uvec3 brick) { return (brick.z * POOL_DOMAIN.bricks_y + brick.y) * POOL_DOMAIN.bricks_x + brick.x; }

uvec3 brickOfIndex(uint index) {
  const uint slice = POOL_DOMAIN.bricks_x * POOL_DOMAIN.bricks_y;
  const uint in_slice = index % slice;
  return uvec3(in_slice % POOL_DOMAIN.bricks_x, in_slice / POOL_DOMAIN.bricks_x, index / slice);
}

// Four densities along i: quad 0 or 1 of a row.
vec4 slabQuad(uint slot, uint quad) {
  const uint at = (slot % BRICKS_PER_DENSITY_SLAB) * BRICK_QUADS + quad;
  const uint slab = slot / BRICKS_PER_DENSITY_SLAB;
  if (kSlabCount == 1 || slab == 0) return slab0[at];
  if (kSlabCount == 2 || slab == 1) return slab1[at];
  if (kSlabCount == 3 || slab == 2) return slab2[at];
  if (kSlabCount == 4 || slab == 3) return slab3[at];
  if (kSlabCount == 5 || slab == 4) return slab4[at];
  if (kSlabCount == 6 || slab == 5) return slab5[at];
  if (kSlabCount == 7 || slab == 6) return slab6[at];
  return slab7[at];
}

// One density of a quad: loads one float instead of four.
float slabElement(uint slot, uint quad, uint element) {
  const uint at = (slot % BRICKS_PER_DENSITY_SLAB) * BRICK_QUADS + quad;
  const uint slab = slot / BRICKS_PER_DENSITY_SLAB;
  if (kSlabCount == 1 || slab == 0) return slab0[at][element];
  if (kSlabCount == 2 || slab == 1) return slab1[at][element];
  if (kSlabCount == 3 || slab == 2) return slab2[at][element];
  if (kSlabCount == 4 || slab == 3) return slab3[at][element];
  if (kSlabCount == 5 || slab == 4) return slab4[at][element];
  if (kSlabCount == 6 || slab == 5) return slab5[at][element];
  if (kSlabCount == 7 || slab == 6) return slab6[at][element];
  return slab7[at][element];
}

struct Row {
  vec4 low, high;  // the eight densities along i
};

// Row (y, z) of a page, y and z within the brick.
Row pageRow(BrickPage page, uint y, uint z) {
  if (page.slot == NO_SLOT) return Row(vec4(page.constant), vec4(page.constant));
  const uint quad = (z * BRICK_EDGE + y) * 2;
  return Row(slabQuad(page.slot, quad), slabQuad(page.slot, quad + 1));
}

// One density of a page, at a voxel of the domain.
float pageDensity(BrickPage page, uvec3 voxel) {
  if (page.slot == NO_SLOT) return page.constant;
  const uvec3 in_brick = voxel % BRICK_EDGE;
  return slabElement(page.slot, (in_brick.z * BRICK_EDGE + in_brick.y) * 2 + in_brick.x / 4, in_brick.x % 4);
}

// One density at a voxel of the domain.
float densityAt(uvec3 voxel) { return pageDensity(pages[brickIndex(voxel / BRICK_EDGE)], voxel); }
