// SPDX-License-Identifier: Apache-2.0
// shaders/gradient.math.glsl: differences along one axis. A missing neighbour is given as the voxel at the border
// itself. Sums and products, each rounded by itself. Read by GLSL and by C++ (shaders/kernel_text.hpp).

// The central difference, one-sided where a neighbour is missing.
PALPATE_TEXT float axisGradient(float before, float after, bool two_sided, float inv_2h_per_m, float inv_h_per_m) {
  precise float difference = after - before;
  precise float gradient = difference * (two_sided ? inv_2h_per_m : inv_h_per_m);
  return gradient;
}

// The fourth-order central difference, for voxels with two neighbours on either side.
PALPATE_TEXT float axisGradient4(float before2, float before, float after, float after2, float inv_12h_per_m) {
  precise float near = after - before;
  precise float far = after2 - before2;
  precise float eight = near * float(8.0);
  precise float sum = eight - far;
  precise float gradient = sum * inv_12h_per_m;
  return gradient;
}

// Four times the mean of three neighbours with weights 1, 2, 1.
PALPATE_TEXT float smoothed3(float before, float middle, float after) {
  precise float outer = before + after;
  precise float twice = middle + middle;
  precise float sum = outer + twice;
  return sum;
}

PALPATE_TEXT vec4 smoothed3(vec4 before, vec4 middle, vec4 after) {
  precise vec4 outer = before + after;
  precise vec4 twice = middle + middle;
  precise vec4 sum = outer + twice;
  return sum;
}
