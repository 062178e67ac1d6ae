// SPDX-License-Identifier: Apache-2.0
// shaders/gradient.math.glsl: the central difference along one axis, one-sided where the neighbour is missing. A missing
// neighbour is given as the voxel itself. A subtraction and a product: nothing that a compiler could contract.
float axisGradient(float before, float after, bool two_sided, float inv_2h_per_m, float inv_h_per_m) {
  precise float difference = after - before;
  precise float gradient = difference * (two_sided ? inv_2h_per_m : inv_h_per_m);
  return gradient;
}
