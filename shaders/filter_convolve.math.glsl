// SPDX-License-Identifier: Apache-2.0
// shaders/filter_convolve.math.glsl: one tap of a convolution: multiply, then add. Read by GLSL and by C++
// (shaders/kernel_text.hpp).

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
