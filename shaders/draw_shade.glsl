// SPDX-License-Identifier: Apache-2.0
// shaders/draw_shade.glsl: normal, ambient occlusion and colour of a point of the isosurface. Include after
// brick_pool.glsl.

const vec3 kBone = vec3(0.90, 0.86, 0.78);
const vec3 kSkin = vec3(0.85, 0.62, 0.52);

// Of the picture, along the lattice's axes: unit vectors in metres.
struct Frame {
  vec3 direction;             // of the ray
  vec3 right, down, forward;  // of the camera
  vec3 spacing_m;
};

// Pages of a brick and of its next ones along some axes, in the order x + 2 y + 4 z; along the other axes the brick is its
// own next one. Most often there is no such axis, so the loop over the others is short.
void pagesOf(uvec3 brick, uint beyond, out BrickPage its[8]) {
  const BrickPage page = pages[brickIndex(brick)];
  [[unroll]] for (int i = 0; i < 8; ++i) its[i] = page;
  [[dont_unroll]] for (uint axes = beyond; axes != 0u; axes = (axes - 1u) & beyond) {
    const BrickPage next = pages[brickIndex(brick + uvec3(axes & 1u, axes >> 1u & 1u, axes >> 2u))];
    [[unroll]] for (int i = 0; i < 8; ++i) {
      if ((uint(i) & beyond) == axes) its[i] = next;
    }
  }
}

uint axesOf(bvec3 which) { return uint(which.x) | uint(which.y) << 1u | uint(which.z) << 2u; }

// Densities at the corners of a cell, in the order x + 2 y + 4 z.
void cornersOf(uvec3 cell, out float corners[8]) {
  BrickPage its[8];
  pagesOf(cell / BRICK_EDGE, axesOf(equal(cell % BRICK_EDGE, uvec3(BRICK_EDGE - 1))), its);
  [[unroll]] for (int i = 0; i < 8; ++i) corners[i] = pageDensity(its[i], cell + uvec3(i & 1, i >> 1 & 1, i >> 2));
}

// Trilinear density at a point [voxel], clamped to the domain.
float trilinear(vec3 p) {
  const vec3 last = vec3(domainSize() - 1);
  const vec3 q = clamp(p, vec3(0), last);
  const uvec3 cell = uvec3(min(floor(q), last - 1));
  float c[8];
  cornersOf(cell, c);
  return cellDensity(c, q - vec3(cell));
}

// Central differences at the eight corners of the cell, interpolated: continuous across cells. Along the lattice's axes,
// over the smallest of the three spacings: of halves, so that it is finite for all densities but the largest.
//
// They need the 4x4x4 voxels around the cell but for the outer edges. These lie in two bricks along each axis at most.
vec3 smoothGradient(ivec3 cell, vec3 place, vec3 spacing_m) {
  const ivec3 last = ivec3(domainSize()) - 1;
  const uvec3 first_brick = uvec3(max(cell - 1, 0)) / BRICK_EDGE, end_brick = uvec3(min(cell + 2, last)) / BRICK_EDGE;
  BrickPage around[8];
  pagesOf(first_brick, axesOf(notEqual(first_brick, end_brick)), around);
  float v[64];
  [[unroll]] for (int n = 0; n < 64; ++n) {
    const ivec3 at = ivec3(n & 3, n >> 2 & 3, n >> 4);
    const ivec3 outer = ivec3(equal(at & 1, at >> 1));  // 0 or 3
    if (outer.x + outer.y + outer.z > 1) continue;
    const uvec3 voxel = uvec3(clamp(cell - 1 + at, ivec3(0), last));
    const bvec3 in_end = equal(voxel / BRICK_EDGE, end_brick);
    BrickPage along_x[4], along_y[2];
    [[unroll]] for (int b = 0; b < 4; ++b) {
      along_x[b].slot = in_end.x ? around[2 * b + 1].slot : around[2 * b].slot;
      along_x[b].constant = in_end.x ? around[2 * b + 1].constant : around[2 * b].constant;
    }
    [[unroll]] for (int b = 0; b < 2; ++b) {
      along_y[b].slot = in_end.y ? along_x[2 * b + 1].slot : along_x[2 * b].slot;
      along_y[b].constant = in_end.y ? along_x[2 * b + 1].constant : along_x[2 * b].constant;
    }
    BrickPage page;
    page.slot = in_end.z ? along_y[1].slot : along_y[0].slot;
    page.constant = in_end.z ? along_y[1].constant : along_y[0].constant;
    v[n] = pageDensity(page, voxel);
  }
  vec3 sum = vec3(0);
  [[unroll]] for (int i = 0; i < 4; ++i) {
    const ivec2 d = ivec2(i & 1, i >> 1);
    const vec3 a = d.x == 1 ? place : 1.0 - place;  // weights of the first other axis
    const vec3 b = d.y == 1 ? place : 1.0 - place;  // and of the second
    // Along an axis: from the cell's corner before it to the one after it, at both ends of the cell.
    [[unroll]] for (int axis = 0; axis < 3; ++axis) {
      const int step = 1 << 2 * axis, corner = ((1 + d.x) << 2 * ((axis + 1) % 3)) + ((1 + d.y) << 2 * ((axis + 2) % 3));
      const float at_low = 0.5 * v[corner + 2 * step] - 0.5 * v[corner];
      const float at_high = 0.5 * v[corner + 3 * step] - 0.5 * v[corner + step];
      sum[axis] += a[(axis + 1) % 3] * b[(axis + 2) % 3] * mix(at_low, at_high, place[axis]);
    }
  }
  return sum * (min(min(spacing_m.x, spacing_m.y), spacing_m.z) / spacing_m);
}

// Length of a vector whose squares may be beyond the floats.
float lengthOf(vec3 v) {
  const float largest = max(max(abs(v.x), abs(v.y)), abs(v.z));
  return largest > 0.0 ? largest * length(v / largest) : 0.0;
}

// How much of the sky above a point is hidden, 0 to 1: along the normal the density falls where the surface is flat,
// and rises towards the isovalue in a hollow.
float occlusion(vec3 p, vec3 normal, float steepness, vec3 spacing_m, float isovalue) {
  float hidden = 0.0;
  float weight = 0.5;
  const float h_m = min(min(spacing_m.x, spacing_m.y), spacing_m.z);
  for (float reach = 1.5; reach < DRAW_OCCLUSION_REACH - 1; reach *= 2.0) {
    const float fall = reach * steepness;
    const float density = trilinear(p + reach * h_m * normal / spacing_m);
    hidden += weight * clamp((density - isovalue) / fall + 1.0, 0.0, 1.0);
    weight *= 0.5;
  }
  return hidden;
}

// Under a head light that sits up and left of the eye, with a little light from behind.
vec3 shade(vec3 base, vec3 normal, vec3 to_eye, vec3 right, vec3 down) {
  const vec3 light = normalize(to_eye - 0.45 * right - 0.6 * down);
  const float diffuse = max(dot(normal, light), 0.0);
  const float facing = abs(dot(normal, to_eye));
  const float gloss = pow(max(dot(reflect(-light, normal), to_eye), 0.0), 24.0);
  return clamp(base * (0.22 + 0.68 * diffuse + 0.10 * facing) + vec3(0.12) * gloss, 0.0, 1.0);
}

// `cell.x` < 0: a cut face with this normal.
vec4 surfaceColour(Frame frame, float isovalue, ivec3 cell, vec3 place, vec3 cut_normal, vec3 base) {
  const bool cut = cell.x < 0;
  const vec3 gradient = smoothGradient(max(cell, 0), place, frame.spacing_m);
  const float steepness = lengthOf(gradient);  // the density's fall over the smallest spacing
  vec3 normal = steepness > 0.0 ? -gradient / steepness : -frame.direction;
  if (cut) normal = dot(cut_normal, cut_normal) > 0.0 ? normalize(cut_normal) : -frame.direction;
  if (kNormals > 0) {
    const vec3 seen = vec3(dot(normal, frame.right), -dot(normal, frame.down), -dot(normal, frame.forward));
    return vec4(0.5 + 0.5 * seen, 1);
  }
  vec3 colour = shade(base, normal, -frame.direction, frame.right, frame.down);
  if (kOcclusion > 0 && !cut) colour *= 1.0 - 0.7 * occlusion(vec3(cell) + place, normal, steepness, frame.spacing_m, isovalue);
  return vec4(colour, 1);
}
