// SPDX-License-Identifier: Apache-2.0
// shaders/filter_distance.math.glsl: arithmetic of the signed distance: where a line between two voxels meets the
// surface, the word that keeps such a point, and the distance from the surface near it. Lengths are in units of the
// smallest spacing. Read by GLSL and by C++ (shaders/kernel_text.hpp).

// Where on the way from a voxel to another, across the surface, it lies: 0 ... 1.
PALPATE_TEXT float crossingOf(float here, float there, float isovalue) {
  precise float to_surface = here - isovalue;
  precise float to_there = here - there;
  precise float share = to_surface / to_there;
  return share;
}

// In steps of a word.
PALPATE_TEXT int steppedOffset(float voxels) {
  precise float steps = voxels * float(DISTANCE_PARTS);
  return int(floor(steps + 0.5f));
}

PALPATE_TEXT uint wordOf(int x, int y, int z) {
  return DISTANCE_KNOWN | uint(x + DISTANCE_MIDDLE) | (uint(y + DISTANCE_MIDDLE) << DISTANCE_FIELD) |
         (uint(z + DISTANCE_MIDDLE) << (2 * DISTANCE_FIELD));
}

// Offset along an axis, in steps.
PALPATE_TEXT int offsetOf(uint word, int axis) {
  return int((word >> uint(axis * DISTANCE_FIELD)) & DISTANCE_MASK) - DISTANCE_MIDDLE;
}

PALPATE_TEXT float squareAlong(float steps, float edge_square) {
  precise float square = (steps * steps) * edge_square;
  return square;
}

PALPATE_TEXT float lerped(float a, float b, float t) {
  precise float between = a + t * (b - a);
  return between;
}

// Gradient (by voxel) and value of the trilinear field in a cell. f000 ... f111: its corners, named by k, j, i.
PALPATE_TEXT vec4 fieldIn(vec4 low, vec4 high, float x, float y, float z) {
  precise float dx00 = low[1] - low[0];
  precise float dx01 = low[3] - low[2];
  precise float dx10 = high[1] - high[0];
  precise float dx11 = high[3] - high[2];
  const float gx = lerped(lerped(dx00, dx01, y), lerped(dx10, dx11, y), z);
  const float f00 = lerped(low[0], low[1], x), f01 = lerped(low[2], low[3], x);
  const float f10 = lerped(high[0], high[1], x), f11 = lerped(high[2], high[3], x);
  precise float dy0 = f01 - f00;
  precise float dy1 = f11 - f10;
  const float gy = lerped(dy0, dy1, z);
  const float f0 = lerped(f00, f01, y), f1 = lerped(f10, f11, y);
  precise float gz = f1 - f0;
  return vec4(gx, gy, gz, lerped(f0, f1, z));
}

// Unit normal, into the object, and steepness of the field [density / unit]. No gradient: NaN.
PALPATE_TEXT vec4 normalOf(vec4 field, vec4 edge) {
  precise float gx = field[0] / edge[0];
  precise float gy = field[1] / edge[1];
  precise float gz = field[2] / edge[2];
  precise float steepness = sqrt((gx * gx + gy * gy) + gz * gz);
  precise float nx = gx / steepness;
  precise float ny = gy / steepness;
  precise float nz = gz / steepness;
  return vec4(nx, ny, nz, steepness);
}

// What is left of the way from a point near the surface to it, along the normal.
PALPATE_TEXT float leftOf(float value, float isovalue, float steepness) {
  precise float left = (value - isovalue) / steepness;
  return left;
}

// How far a voxel lies from the tangent plane along the normal. away_*: from the surface point to the voxel.
PALPATE_TEXT float riseOf(vec4 normal, float away_x, float away_y, float away_z, float left) {
  precise float rise = ((normal[0] * away_x + normal[1] * away_y) + normal[2] * away_z) + left;
  return rise;
}

PALPATE_TEXT float awaySquare(float away_x, float away_y, float away_z) {
  precise float square = (away_x * away_x + away_y * away_y) + away_z * away_z;
  return square;
}

// How far a voxel lies beside the normal.
PALPATE_TEXT float sideOf(float away_square, float height) {
  precise float square = away_square - height * height;
  return sqrt(square > 0.0f ? square : 0.0f);
}

// Distance from the surface, of a voxel `height` over the tangent plane and `side` beside the surface point. The plane
// stands for the surface as far as `slack`; beyond twice that the distance is that of the point itself, in between it
// goes over from one to the other. Without a gradient, or where the plane has the voxel on the other side, it is the
// point's too.
PALPATE_TEXT float distanceOver(float height, float side, float slack, float away_square) {
  precise float partly = 2.0f * (side - slack);
  float beside = partly < side ? partly : side;
  precise float slanted = sqrt(height * height + beside * beside);
  const float distance = side > slack ? slanted : height;
  return height >= 0.0f ? distance : sqrt(away_square);
}

// Inside it is positive, however close. (Not 0 - x for -x: compilers make one of the other, and -0 of 0.)
PALPATE_TEXT float signedDistance(float distance, float unit, bool inside) {
  const float least = 1e-6f;
  precise float positive = (distance > least ? distance : least) * unit;
  precise float away = distance * unit;
  const float negative = away > 0.0f ? -away : 0.0f;
  return inside ? positive : negative;
}
