// SPDX-License-Identifier: Apache-2.0
// shaders/picture.layout.h: the rays of a picture's pixels, and the pixels, as kernels that draw take and give them.
#ifndef PALPATE_PICTURE_LAYOUT_H
#define PALPATE_PICTURE_LAYOUT_H
#include "layout_types.h"

#define PICTURE_MOST_SIDE 16384         // [pixel]
#define PICTURE_MOST_PIXELS 16777216    // 8 bytes each: 128 MiB, all that Vulkan guarantees for a binding
#define PICTURE_BACKGROUND 0x00faf7f6u  // light; as a pixel that shows nothing

PALPATE_LAYOUT_BEGIN

// The ray through pixel (x, y): eye + t * unit(corner + x * right + y * down), t in metres. The eye is given in voxels,
// the directions in metres along the lattice's axes, so that anisotropic spacing needs no matrix.
struct PictureRays {
  float spacing_x, spacing_y, spacing_z;  // [m]
  float eye_x, eye_y, eye_z;              // [voxel]
  float corner_x, corner_y, corner_z;     // [m]
  float right_x, right_y, right_z;        // one pixel to the right [m]
  float down_x, down_y, down_z;           // one pixel down [m]
};

struct PicturePixel {
  uint rgba;         // 8 bits each, red lowest; alpha: how much it hides of what is behind
  float distance_m;  // along the ray; infinity where nothing opaque is hit [m]
};

// A pixel before a background, which is opaque.
PALPATE_TEXT uint pictureOver(uint rgba, uint background) {
  const uint alpha = rgba >> 24;
  uint over = 0xff000000u;
  for (uint shift = 0; shift < 24u; shift += 8u) {
    const uint sum = (rgba >> shift & 255u) * alpha + (background >> shift & 255u) * (255u - alpha);
    over |= (sum + 127u) / 255u << shift;
  }
  return over;
}

PALPATE_LAYOUT_CHECK(PictureRays, 60)
PALPATE_LAYOUT_CHECK(PicturePixel, 8)

PALPATE_LAYOUT_END
#endif
