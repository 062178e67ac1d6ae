// SPDX-License-Identifier: Apache-2.0
// shaders/gradient_smoothed.comp: gradient.comp on a smoothed field. The samples' densities are not smoothed: they come
// from a second pool.
#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_control_flow_attributes : require
#include "gradient.layout.h"

layout(local_size_x_id = GRADIENT_CONSTANT_GROUP) in;
layout(push_constant) uniform Push { GradientPush push; };
#define POOL_DOMAIN push.domain
#include "brick_pool.glsl"

layout(constant_id = GRADIENT_CONSTANT_DENSITY) const uint kDensitySlabs = 1;
layout(std430, binding = GRADIENT_BINDING_DENSITY_PAGES) readonly buffer DensityPages { BrickPage density_pages[]; };
layout(std430, binding = GRADIENT_BINDING_DENSITY_SLABS + 0) readonly buffer DensitySlab0 { vec4 density0[]; };
layout(std430, binding = GRADIENT_BINDING_DENSITY_SLABS + 1) readonly buffer DensitySlab1 { vec4 density1[]; };
layout(std430, binding = GRADIENT_BINDING_DENSITY_SLABS + 2) readonly buffer DensitySlab2 { vec4 density2[]; };
layout(std430, binding = GRADIENT_BINDING_DENSITY_SLABS + 3) readonly buffer DensitySlab3 { vec4 density3[]; };
layout(std430, binding = GRADIENT_BINDING_DENSITY_SLABS + 4) readonly buffer DensitySlab4 { vec4 density4[]; };
layout(std430, binding = GRADIENT_BINDING_DENSITY_SLABS + 5) readonly buffer DensitySlab5 { vec4 density5[]; };
layout(std430, binding = GRADIENT_BINDING_DENSITY_SLABS + 6) readonly buffer DensitySlab6 { vec4 density6[]; };
layout(std430, binding = GRADIENT_BINDING_DENSITY_SLABS + 7) readonly buffer DensitySlab7 { vec4 density7[]; };

vec4 densityQuad(uint slot, uint quad) {
  const uint at = (slot % BRICKS_PER_DENSITY_SLAB) * BRICK_QUADS + quad;
  if (kDensitySlabs == 1) return density0[at];
  switch (slot / BRICKS_PER_DENSITY_SLAB) {
    case 0: return density0[at];
    case 1: return density1[at];
    case 2: return density2[at];
    case 3: return density3[at];
    case 4: return density4[at];
    case 5: return density5[at];
    case 6: return density6[at];
    default: return density7[at];
  }
}

Row densityRow(uint brick, uint row_index) {
  const BrickPage page = density_pages[brick];
  if (page.slot == NO_SLOT) return Row(vec4(page.constant), vec4(page.constant));
  return Row(densityQuad(page.slot, row_index * 2), densityQuad(page.slot, row_index * 2 + 1));
}
#define OWN_DENSITY
#include "gradient_row.glsl"
