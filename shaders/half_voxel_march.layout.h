// SPDX-License-Identifier: Apache-2.0
// shaders/half_voxel_march.layout.h: push constants and bindings of the kernel that drew the isosurface before
// draw.comp (apps/bench/half_voxel_march.hpp).
#ifndef PALPATE_HALF_VOXEL_MARCH_LAYOUT_H
#define PALPATE_HALF_VOXEL_MARCH_LAYOUT_H
#include "brick_pool.layout.h"
#include "picture.layout.h"

#define HALF_VOXEL_MARCH_BINDING_BOUNDS BINDING_OWN
#define HALF_VOXEL_MARCH_BINDING_PIXELS (BINDING_OWN + 1)
#define HALF_VOXEL_MARCH_BINDINGS (BINDING_OWN + 2)
#define HALF_VOXEL_MARCH_GROUP 8       // pixels along a side of a work group
#define HALF_VOXEL_MARCH_BISECTIONS 6  // bring a step of half a voxel to 1/128 voxel

PALPATE_LAYOUT_BEGIN

struct HalfVoxelMarchPush {
  PoolDomain domain;
  uint width, height;  // [pixel]
  float isovalue;      // [density]
  PictureRays rays;
  uint first_row;  // first row of the band of rows that is drawn [pixel]
};

PALPATE_LAYOUT_CHECK(HalfVoxelMarchPush, 100)
PALPATE_PUSH_CHECK(HalfVoxelMarchPush)

PALPATE_LAYOUT_END
#endif
