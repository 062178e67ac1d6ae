// SPDX-License-Identifier: Apache-2.0
// shaders/sample_code.math.glsl: converts floats to halves and back, in integers, since Vulkan leaves the rounding of
// packHalf2x16 to the device. Read by GLSL and by C++ (shaders/kernel_text.hpp).

// The half nearest to a float; the even one of two that are equally near. Beyond 65504 it is 65504. Not for NaN.
PALPATE_TEXT uint halfOf(float value) {
  const uint bits = floatBitsToUint(value);
  const uint magnitude = bits & 0x7fffffffu;
  const uint size = magnitude > 0x477fe000u ? 0x477fe000u : magnitude;
  // A half has 13 bits fewer, and its exponent is biased by 15 instead of 127.
  const uint normal = (size + 0xfffu + ((size >> 13) & 1u) - 0x38000000u) >> 13;
  // Below 2^-14 a half counts in 2^-24, as a float between 0.5 and 1 does: the addition rounds.
  precise float counted = uintBitsToFloat(size) + float(0.5);
  const uint small = floatBitsToUint(counted) - 0x3f000000u;
  return ((bits >> 16) & 0x8000u) | (size < 0x38800000u ? small : normal);
}

PALPATE_TEXT float ofHalf(uint half_bits) {
  const uint size = half_bits & 0x7fffu;
  const float counted = float(size) * uintBitsToFloat(0x33800000u);  // 2^-24
  const uint bits = size < 0x400u ? floatBitsToUint(counted) : (size << 13) + 0x38000000u;
  return uintBitsToFloat(bits | ((half_bits & 0x8000u) << 16));
}

// Stored density: one rounded difference, then an exact product.
PALPATE_TEXT float storedDensity(float density, float zero, float scale) {
  precise float distance = density - zero;
  precise float stored = distance * scale;
  return stored;
}

PALPATE_TEXT float densityOf(float stored, float zero, float inv_scale) {
  precise float distance = stored * inv_scale;
  precise float density = distance + zero;
  return density;
}

PALPATE_TEXT float scaled(float value, float scale) {
  precise float product = value * scale;
  return product;
}
