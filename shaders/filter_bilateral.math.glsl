// SPDX-License-Identifier: Apache-2.0
// shaders/filter_bilateral.math.glsl: one neighbour's part in a bilateral mean (Tomasi and Manduchi 1998). It averages
// differences from the voxel, not densities, so that a constant stays as it is, bit for bit. Read by GLSL and by C++
// (shaders/kernel_text.hpp); needs filter_exp.math.glsl.

struct BilateralSums {
  float parts;    // sum of weighted differences from the voxel
  float weights;  // sum of the weights
};

PALPATE_TEXT BilateralSums bilateralNothing() {
  BilateralSums sums;
  sums.parts = 0.0f;
  sums.weights = 0.0f;
  return sums;
}

// Weight of a neighbour by its place: the product of the weights along the axes.
PALPATE_TEXT float placeTap(float tap, float other_tap) {
  precise float product = tap * other_tap;
  return product;
}

// Adds a neighbour. If its difference overflows it weighs nothing; the range is 1e30 at most.
PALPATE_TEXT BilateralSums bilateralAdded(BilateralSums sums, float place_tap, float neighbour, float density,
                                          float inv_range) {
  precise float difference = neighbour - density;
  precise float s = difference * inv_range;
  precise float weight = place_tap * gaussianOf(s);
  precise float part = weight * difference;
  precise float parts = sums.parts + (weight > 0.0f ? part : 0.0f);
  precise float weights = sums.weights + weight;
  BilateralSums more;
  more.parts = parts;
  more.weights = weights;
  return more;
}

PALPATE_TEXT float bilateralResult(float density, BilateralSums sums) {
  precise float mean = sums.parts / sums.weights;
  precise float result = density + mean;
  return result;
}
