// SPDX-License-Identifier: Apache-2.0
// shaders/draw_cell.math.glsl: where a ray first meets the isosurface in one cell. Read by GLSL and by C++
// (shaders/kernel_text.hpp).
//
// Within a cell the density is trilinear, so along a ray it is a polynomial of third degree. Between its extrema it is
// monotone, and there an interval whose ends differ in sign holds one root.
//
// Corners are in the order x + 2 y + 4 z. A point of the cell has coordinates from 0 to 1.

// Corners relative to the isovalue and scaled to at most 1, so that no product of densities overflows. The sign says
// whether a corner is object.
PALPATE_TEXT void scaleCorners(PALPATE_INOUT_ARRAY(float, corners, 8), float isovalue) {
  float largest = 0.0f;
  for (int i = 0; i < 8; ++i) {
    corners[i] = 0.5f * corners[i] - 0.5f * isovalue;
    largest = max(largest, abs(corners[i]));
  }
  if (largest > 0.0f) {
    for (int i = 0; i < 8; ++i) corners[i] = corners[i] / largest;
  }
}

// Exact at both ends: at a face of the cell only the face's own corners count.
PALPATE_TEXT float blended(float a, float b, float t) { return a * (1.0f - t) + b * t; }

PALPATE_TEXT float cellDensity(PALPATE_IN_ARRAY(float, c, 8), vec3 p) {
  const float low = blended(blended(c[0], c[1], p.x), blended(c[2], c[3], p.x), p.y);
  const float high = blended(blended(c[4], c[5], p.x), blended(c[6], c[7], p.x), p.y);
  return blended(low, high, p.z);
}

// Where the polynomial along from + u * (to - from) has its extrema, ascending and cut to [0, 1].
struct CellExtrema {
  float first, second;
};
PALPATE_TEXT CellExtrema cellExtrema(PALPATE_IN_ARRAY(float, c, 8), vec3 p, vec3 q) {
  const float kx = c[1] - c[0], ky = c[2] - c[0], kz = c[4] - c[0];
  const float kxy = c[3] - c[1] - ky, kxz = c[5] - c[1] - kz, kyz = c[6] - c[2] - kz;
  const float kxyz = c[7] - c[6] - c[5] + c[4] - c[3] + c[2] + c[1] - c[0];
  // The derivative is three3 u^2 + 2 two u + one.
  const float three3 = 3.0f * kxyz * q.x * q.y * q.z;
  const float two = kxy * q.x * q.y + kxz * q.x * q.z + kyz * q.y * q.z +
                    kxyz * (p.x * q.y * q.z + p.y * q.x * q.z + p.z * q.x * q.y);
  const float one = kx * q.x + ky * q.y + kz * q.z + kxy * (p.x * q.y + p.y * q.x) + kxz * (p.x * q.z + p.z * q.x) +
                    kyz * (p.y * q.z + p.z * q.y) + kxyz * (p.x * p.y * q.z + p.x * p.z * q.y + p.y * p.z * q.x);
  const float discriminant = two * two - three3 * one;
  CellExtrema extrema;
  extrema.first = 0.0f;
  extrema.second = 0.0f;
  if (!(discriminant > 0.0f)) return extrema;
  const float root = sqrt(discriminant);
  const float sum = two < 0.0f ? root - two : -root - two;  // without cancellation
  // A quotient beyond the floats lies outside the cell, as does one of 0 by 0: then the polynomial is a line.
  const float a = three3 != 0.0f ? clamp(sum / three3, 0.0f, 1.0f) : 0.0f;
  const float b = sum != 0.0f ? clamp(one / sum, 0.0f, 1.0f) : 0.0f;
  extrema.first = min(a, b);
  extrema.second = max(a, b);
  return extrema;
}

// Fractions of the way from `from` to `to` between which the density first exceeds the isovalue, and the densities
// there. Nothing is found where `at_high` is not above 0. Where the way begins in the object, both are 0, and `at_low` is
// any density below 0.
struct CellInterval {
  float low, high;
  float at_low, at_high;
};
// `c`: scaled corners. Source: Marmitt et al. 2004, "Fast and Accurate Ray-Voxel Intersection Techniques for Iso-Surface
// Ray Tracing".
PALPATE_TEXT CellInterval firstInterval(PALPATE_IN_ARRAY(float, c, 8), vec3 from, vec3 to) {
  const vec3 way = to - from;
  CellInterval found;
  found.low = 0.0f;
  found.high = 1.0f;
  found.at_low = cellDensity(c, from);
  found.at_high = cellDensity(c, to);
  if (found.at_low > 0.0f) {  // the way begins in the object
    found.high = 0.0f;
    found.at_high = found.at_low;
    found.at_low = -1.0f;
    return found;
  }
  const CellExtrema extrema = cellExtrema(c, from, way);
  const float at_first = cellDensity(c, from + way * extrema.first);
  const float at_second = cellDensity(c, from + way * extrema.second);
  if (at_first > 0.0f) {
    found.high = extrema.first;
    found.at_high = at_first;
  } else if (at_second > 0.0f) {
    found.low = extrema.first;
    found.at_low = at_first;
    found.high = extrema.second;
    found.at_high = at_second;
  } else {
    found.low = extrema.second;
    found.at_low = at_second;
  }
  return found;
}

// The fraction of the way at which the density first exceeds the isovalue. `within`: where something was found. By
// the Illinois method.
PALPATE_TEXT float rootIn(CellInterval within, PALPATE_IN_ARRAY(float, c, 8), vec3 from, vec3 to) {
  float low = within.low, high = within.high;
  float at_low = within.at_low, at_high = within.at_high;
  const vec3 way = to - from;
  float kept = 0.0f;  // the end that stayed last time: 1 high, -1 low
  for (int i = 0; i < DRAW_ROOT_STEPS; ++i) {
    const float middle = clamp(high - at_high * (high - low) / (at_high - at_low), low, high);
    const float at_middle = cellDensity(c, from + way * middle);
    if (at_middle > 0.0f) {
      high = middle;
      at_high = at_middle;
      if (kept < 0.0f) at_low = 0.5f * at_low;
      kept = -1.0f;
    } else {
      low = middle;
      at_low = at_middle;
      if (kept > 0.0f) at_high = 0.5f * at_high;
      kept = 1.0f;
    }
  }
  return clamp(high - at_high * (high - low) / (at_high - at_low), low, high);
}
