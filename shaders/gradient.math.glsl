// SPDX-License-Identifier: Apache-2.0
// shaders/gradient.math.glsl: differences along one axis. For a missing neighbour the caller passes the border voxel
// itself. Each sum and each product is rounded by itself. Read by GLSL and by C++ (shaders/kernel_text.hpp).

// Whether a voxel has `voxels` neighbours on either side along an axis. `last`: the domain's last coordinate.
PALPATE_TEXT bool hasEitherSide(uint c, uint last, uint voxels) { return c >= voxels && c + voxels <= last; }

// The central difference, one-sided where a neighbour is missing.
PALPATE_TEXT float axisGradient(float before, float after, bool two_sided, float inv_2h_per_m, float inv_h_per_m) {
  precise float difference = after - before;
  precise float gradient = difference * (two_sided ? inv_2h_per_m : inv_h_per_m);
  return gradient;
}

// The fourth-order central difference, for voxels with two neighbours on either side. Everything is divided by 32 until
// the last product, so no difference or sum overflows where the gradient does not. That loses bits of denormals only.
PALPATE_TEXT float axisGradient4(float before2, float before, float after, float after2, float inv_12h_per_m) {
  precise float near = 0.25f * after - 0.25f * before;
  precise float far = 0.03125f * after2 - 0.03125f * before2;
  precise float sum = near - far;
  precise float gradient = sum * (32.0f * inv_12h_per_m);
  return gradient;
}

// The difference that an operator uses at a voxel, depending on its number of neighbours. `fourth`: the operator is
// GRADIENT_CENTRAL4.
PALPATE_TEXT float stencilGradient(bool fourth, uint c, uint last, float before2, float before, float after,
                                   float after2, float inv_2h_per_m, float inv_h_per_m, float inv_12h_per_m) {
  const float second_order = axisGradient(before, after, hasEitherSide(c, last, 1u), inv_2h_per_m, inv_h_per_m);
  const float fourth_order = axisGradient4(before2, before, after, after2, inv_12h_per_m);
  return fourth && hasEitherSide(c, last, 2u) ? fourth_order : second_order;
}
