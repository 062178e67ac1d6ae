// SPDX-License-Identifier: Apache-2.0
// shaders/filter_convolve.math.glsl: one tap of a convolution: multiply, then add. The taps sum to one, so a sum can
// only overflow within a rounding of the largest density. finite() (numbers.math.glsl) then yields the largest density.
// Read by GLSL and by C++ (shaders/kernel_text.hpp).

PALPATE_TEXT float firstTap(float tap, float value) {
  precise float part = tap * value;
  return part;
}

PALPATE_TEXT vec4 firstTap(float tap, vec4 value) {
  precise vec4 part = tap * value;
  return part;
}

PALPATE_TEXT float addTap(float sum, float tap, float value) {
  precise float part = tap * value;
  precise float more = sum + part;
  return more;
}

PALPATE_TEXT vec4 addTap(vec4 sum, float tap, vec4 value) {
  precise vec4 part = tap * value;
  precise vec4 more = sum + part;
  return more;
}
