// SPDX-License-Identifier: Apache-2.0
// shaders/filter_border.math.glsl: maps coordinates beyond the border into the domain. Read by GLSL and by C++
// (shaders/kernel_text.hpp).

// `border`: BORDER_NEAREST, or BORDER_MIRROR, which mirrors at the faces of the outermost voxels as often as needed.
PALPATE_TEXT int insideOf(int c, int size, uint border) {
  if (border == BORDER_NEAREST) return clamp(c, 0, size - 1);
  const int period = 2 * size;
  int m = c - period * int(floor(float(c) / float(period)));
  m += m < 0 ? period : 0;  // a division may be off by 2.5 ULP, so the floor may be off by one
  m -= m >= period ? period : 0;
  return m < size ? m : period - 1 - m;
}
