// SPDX-License-Identifier: Apache-2.0
// shaders/half_voxel_march.math.glsl: trilinear density and its smooth gradient, and the shading.

// Reads densities as this kernel did when it was replaced, four at a time, so that what it is compared with stays.
float quadDensityAt(uvec3 voxel) {
  const BrickPage page = pages[brickIndex(voxel / BRICK_EDGE)];
  if (page.slot == NO_SLOT) return page.constant;
  const uvec3 in_brick = voxel % BRICK_EDGE;
  const uint quad = (in_brick.z * BRICK_EDGE + in_brick.y) * 2 + in_brick.x / 4;
  return slabQuad(page.slot, quad)[in_brick.x % 4];
}

// Trilinear density at a point in voxels, clamped to the domain.
float trilinear(vec3 p) {
  const vec3 last = vec3(domainSize() - 1);
  const vec3 q = clamp(p, vec3(0), last);
  const uvec3 cell = uvec3(min(floor(q), last - 1));
  const vec3 f = q - vec3(cell);
  const float c00 = mix(quadDensityAt(cell), quadDensityAt(cell + uvec3(1, 0, 0)), f.x);
  const float c10 = mix(quadDensityAt(cell + uvec3(0, 1, 0)), quadDensityAt(cell + uvec3(1, 1, 0)), f.x);
  const float c01 = mix(quadDensityAt(cell + uvec3(0, 0, 1)), quadDensityAt(cell + uvec3(1, 0, 1)), f.x);
  const float c11 = mix(quadDensityAt(cell + uvec3(0, 1, 1)), quadDensityAt(cell + uvec3(1, 1, 1)), f.x);
  return mix(mix(c00, c10, f.y), mix(c01, c11, f.y), f.z);
}

// Central difference over one voxel of the trilinear density, per metre along the lattice's axes.
vec3 smoothGradient(vec3 p, vec3 spacing_m) {
  const vec3 difference = vec3(trilinear(p + vec3(1, 0, 0)) - trilinear(p - vec3(1, 0, 0)),
                               trilinear(p + vec3(0, 1, 0)) - trilinear(p - vec3(0, 1, 0)),
                               trilinear(p + vec3(0, 0, 1)) - trilinear(p - vec3(0, 0, 1)));
  return difference / (2.0 * spacing_m);
}

// Warm grey surface under a head light that sits up and left of the eye, with a little light from behind.
vec3 shade(vec3 normal, vec3 to_eye, vec3 right, vec3 down) {
  const vec3 light = normalize(to_eye - 0.45 * right - 0.6 * down);
  const float diffuse = max(dot(normal, light), 0.0);
  const float facing = abs(dot(normal, to_eye));
  const float gloss = pow(max(dot(reflect(-light, normal), to_eye), 0.0), 24.0);
  const vec3 colour = vec3(0.90, 0.86, 0.78) * (0.22 + 0.68 * diffuse + 0.10 * facing) + vec3(0.12) * gloss;
  return clamp(colour, 0.0, 1.0);
}
