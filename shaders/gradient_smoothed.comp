// SPDX-License-Identifier: Apache-2.0
// shaders/gradient_smoothed.comp: gradient.comp on a smoothed field, of which only the gradient is taken: the samples'
// densities are those of a second pool.
#version 460
#extension GL_GOOGLE_include_directive : require
#include "gradient.layout.h"

layout(local_size_x = BRICK_ROWS) in;
layout(push_constant) uniform Push { GradientPush push; };
#define POOL_DOMAIN push.domain
#include "brick_pool.glsl"

layout(constant_id = GRADIENT_CONSTANT_DENSITY) const uint kDensitySlabs = 1;
layout(std430, binding = GRADIENT_BINDING_DENSITY_PAGES) readonly buffer DensityPages { BrickPage density_pages[]; };
layout(std430, binding = GRADIENT_BINDING_DENSITY_SLABS) readonly buffer DensitySlabs { vec4 quads[]; } density_slabs[DENSITY_SLABS];

vec4 densityQuad(uint slot, uint quad) {
  const uint at = (slot % BRICKS_PER_DENSITY_SLAB) * BRICK_QUADS + quad;
  if (kDensitySlabs == 1) return density_slabs[0].quads[at];
  switch (slot / BRICKS_PER_DENSITY_SLAB) {
    case 0: return density_slabs[0].quads[at];
    case 1: return density_slabs[1].quads[at];
    case 2: return density_slabs[2].quads[at];
    case 3: return density_slabs[3].quads[at];
    case 4: return density_slabs[4].quads[at];
    case 5: return density_slabs[5].quads[at];
    case 6: return density_slabs[6].quads[at];
    default: return density_slabs[7].quads[at];
  }
}

Row densityRow(uint brick, uint row_index) {
  const BrickPage page = density_pages[brick];
  if (page.slot == NO_SLOT) return Row(vec4(page.constant), vec4(page.constant));
  return Row(densityQuad(page.slot, row_index * 2), densityQuad(page.slot, row_index * 2 + 1));
}
#define OWN_DENSITY
#include "gradient_row.glsl"
