// SPDX-License-Identifier: Apache-2.0
// shaders/filter_bilateral.math.glsl: one neighbour's part in a bilateral mean (Tomasi and Manduchi 1998). Differences
// are averaged rather than densities, so that a constant stays as it is, bit for bit. Read by GLSL and by C++
// (shaders/kernel_text.hpp); needs filter_exp.math.glsl.

// Weight of a neighbour whose density differs by `difference`. One that overflows weighs nothing.
PALPATE_TEXT float bilateralWeight(float tap, float difference, float inv_range) {
  precise float s = difference * inv_range;
  precise float weight = tap * gaussianOf(s);
  return weight;
}

PALPATE_TEXT float bilateralPart(float weight, float difference) {
  precise float part = weight * difference;
  return weight > 0.0f ? part : 0.0f;
}

PALPATE_TEXT float bilateralResult(float density, float parts, float weights) {
  precise float mean = parts / weights;
  precise float result = density + mean;
  return result;
}
