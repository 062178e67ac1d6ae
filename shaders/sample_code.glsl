// SPDX-License-Identifier: Apache-2.0
// shaders/sample_code.glsl: packs a sample into two words and unpacks it. Define SAMPLE_CODE as the push constant's
// member.
#include "sample_code.math.glsl"

uvec2 packedSample(vec4 value) {
  const float density = storedDensity(value.w, SAMPLE_CODE.zero, SAMPLE_CODE.density_scale);
  const uint i = halfOf(scaled(value.x, SAMPLE_CODE.gradient_scale));
  const uint j = halfOf(scaled(value.y, SAMPLE_CODE.gradient_scale));
  const uint k = halfOf(scaled(value.z, SAMPLE_CODE.gradient_scale));
  return uvec2(i | (j << 16), k | (halfOf(density) << 16));
}

// SAMPLE_CODE must hold the inverse scales.
vec4 unpackedSample(uvec2 words) {
  return vec4(scaled(ofHalf(words.x & 0xffffu), SAMPLE_CODE.gradient_scale),
              scaled(ofHalf(words.x >> 16), SAMPLE_CODE.gradient_scale),
              scaled(ofHalf(words.y & 0xffffu), SAMPLE_CODE.gradient_scale),
              densityOf(ofHalf(words.y >> 16), SAMPLE_CODE.zero, SAMPLE_CODE.density_scale));
}
