// SPDX-License-Identifier: Apache-2.0
// shaders/isosurface.layout.h: push constants and bindings of the isosurface ray marcher.
#ifndef PALPATE_ISOSURFACE_LAYOUT_H
#define PALPATE_ISOSURFACE_LAYOUT_H
#include "brick_pool.layout.h"

#define ISOSURFACE_BINDING_BOUNDS BINDING_OWN
#define ISOSURFACE_BINDING_PIXELS (BINDING_OWN + 1)
#define ISOSURFACE_BINDINGS (BINDING_OWN + 2)
#define ISOSURFACE_GROUP 8       // pixels along a side of a work group
#define ISOSURFACE_BISECTIONS 6  // bring a step of half a voxel to 1/128 voxel

PALPATE_LAYOUT_BEGIN

// A ray through pixel (x, y): eye + t * unit(corner + x * right + y * down), t in metres. The eye is given in voxels,
// the directions in metres along the lattice's axes, so that anisotropic spacing needs no matrix.
struct IsosurfacePush {
  PoolDomain domain;
  uint width, height;                     // [pixel]
  float isovalue;                         // [density]
  float spacing_x, spacing_y, spacing_z;  // [m]
  float eye_x, eye_y, eye_z;              // [voxel]
  float corner_x, corner_y, corner_z;     // [m]
  float right_x, right_y, right_z;        // one pixel to the right [m]
  float down_x, down_y, down_z;           // one pixel down [m]
  uint first_row;                         // first row of the band of rows that is drawn [pixel]
};

struct IsosurfacePixel {
  uint rgba;         // 8 bits each, red lowest
  float distance_m;  // along the ray; infinity where nothing is hit [m]
};

PALPATE_LAYOUT_CHECK(IsosurfacePush, 100)
PALPATE_LAYOUT_CHECK(IsosurfacePixel, 8)
PALPATE_PUSH_CHECK(IsosurfacePush)

PALPATE_LAYOUT_END
#endif
