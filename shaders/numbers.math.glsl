// SPDX-License-Identifier: Apache-2.0
// shaders/numbers.math.glsl: small functions of numbers that several kernels share. Read by GLSL and by C++
// (shaders/kernel_text.hpp).

#define LARGEST_DENSITY 3.40282347e38f

// Replaces infinities by the largest float of their sign. Not for NaN.
PALPATE_TEXT float finite(float value) { return clamp(value, -LARGEST_DENSITY, LARGEST_DENSITY); }
PALPATE_TEXT vec4 finite(vec4 value) { return clamp(value, -LARGEST_DENSITY, LARGEST_DENSITY); }

// If both arguments are zero, GLSL's min and max may return a zero of either sign. These return `a` unless b is less,
// or greater.
PALPATE_TEXT vec4 lesser(vec4 a, vec4 b) { return mix(a, b, lessThan(b, a)); }
PALPATE_TEXT vec4 greater(vec4 a, vec4 b) { return mix(a, b, lessThan(a, b)); }

PALPATE_TEXT bvec4 both(bvec4 a, bvec4 b) { return bvec4(uvec4(a) & uvec4(b)); }

PALPATE_TEXT float lerped(float a, float b, float t) {
  precise float between = a + t * (b - a);
  return between;
}
