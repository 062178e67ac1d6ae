// SPDX-License-Identifier: Apache-2.0
// shaders/filter.glsl: the common part of the filter kernels: their tasks, their results, and how they read beyond a
// brick. Include after the push constant `push`, which begins as FilterPush does.
//
// Most filter kernels are compiled twice. The variant for bricks within reach of the border (kEdge == 1) maps each
// voxel's coordinates. The other variant takes whole quads from neighbouring bricks and ignores borders. Diffusion and
// distances treat all bricks alike. In every pool, voxels of a brick outside the domain repeat the nearest one inside.
// So only coordinates along the filter's own axes are mapped.
#define POOL_DOMAIN push.domain
#include "brick_pool.glsl"
#include "filter_border.math.glsl"

layout(constant_id = FILTER_CONSTANT_EDGE) const uint kEdge = 0;
layout(constant_id = FILTER_CONSTANT_BORDER) const uint kBorder = BORDER_NEAREST;

layout(std430, binding = FILTER_BINDING_TASKS) readonly buffer Tasks { FilterTask tasks[]; };
#ifndef FILTER_RESULT_ACCESS
#define FILTER_RESULT_ACCESS writeonly  // a kernel that rewrites its results defines it as nothing
#endif
#ifdef FILTER_RESULT_FLOATS
layout(std430, binding = FILTER_BINDING_RESULT) FILTER_RESULT_ACCESS buffer Result { float result_float[]; };
#else
layout(std430, binding = FILTER_BINDING_RESULT) FILTER_RESULT_ACCESS buffer Result { vec4 result[]; };
#endif
layout(std430, binding = FILTER_BINDING_TAPS) readonly buffer Taps { float taps[]; };

// The coordinate inside the domain that stands for a coordinate beyond the border.
int mapped(int c, int size) { return insideOf(c, size, kBorder); }

// Quad of a brick: four densities along i.
vec4 pageQuad(BrickPage page, uint quad) {
  if (page.slot == NO_SLOT) return vec4(page.constant);
  return slabQuad(page.slot, quad);
}

// The quad that holds a voxel of the domain's bricks.
vec4 quadAt(uvec3 voxel) {
  const uvec3 in_brick = voxel % BRICK_EDGE;
  return pageQuad(pages[brickIndex(voxel / BRICK_EDGE)], (in_brick.z * BRICK_EDGE + in_brick.y) * 2 + in_brick.x / 4);
}

// One density of a brick; loads that one only.
float pageDensity(BrickPage page, uint quad, uint element) {
  if (page.slot == NO_SLOT) return page.constant;
  return slabElement(page.slot, quad, element);
}
