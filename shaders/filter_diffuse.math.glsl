// SPDX-License-Identifier: Apache-2.0
// shaders/filter_diffuse.math.glsl: one time step of anisotropic diffusion at a voxel (Perona and Malik 1990, both of
// their conductances). What flows out of a voxel through a face flows into its neighbour there, bit for bit. Read by
// GLSL and by C++ (shaders/kernel_text.hpp); needs filter_exp.math.glsl.

// Flow through one face. `difference`: the density behind the face minus that of the voxel. If its square overflows
// nothing flows; kappa is 1e30 at most.
PALPATE_TEXT float faceFlow(float difference, float inv_slope, bool exponential) {
  precise float s = difference * inv_slope;
  precise float square = s * s;
  precise float share = 1.0f + square;
  precise float rational = 1.0f / share;
  const float conductance = exponential ? gaussianOf(s) : rational;
  precise float flow = conductance * difference;
  return conductance > 0.0f ? flow : 0.0f;
}

// Inflow along an axis, through both faces.
PALPATE_TEXT float axisInflow(float before, float here, float after, float rate, float inv_slope, bool exponential) {
  precise float to_after = after - here;
  precise float to_before = before - here;
  precise float sum = faceFlow(to_before, inv_slope, exponential) + faceFlow(to_after, inv_slope, exponential);
  precise float inflow = rate * sum;
  return inflow;
}

// Density after the step, from the inflows along the axes.
PALPATE_TEXT float diffused(float here, float x, float y, float z) {
  precise float inflow = (x + y) + z;
  precise float after = here + inflow;
  return after;
}
