// SPDX-License-Identifier: Apache-2.0
// shaders/gradient_sobel.math.glsl: the Sobel operator on rows of eight voxels: the difference along one axis, weighted
// by 1, 2, 1 along both other axes. The weights sum to 16. Densities are divided by 16 first, so that no sum overflows;
// that loses bits of denormals only. Each sum is rounded by itself. Read by GLSL and by C++ (shaders/kernel_text.hpp).

struct SobelRow {
  float left, right;  // the densities before and after the row
  vec4 low, high;     // its eight densities
};

// The part of a gradient that comes from three rows next to each other along j.
struct SobelSlice {
  float left, right;               // smoothed along j: before and after the row
  vec4 low, high;                  // smoothed along j: its eight voxels
  vec4 difference_low, difference_high;  // smoothed along i: the last row minus the first
  vec4 smooth_low, smooth_high;          // smoothed along i, then j
};

// For each axis: smoothed along the other two, the neighbour after a voxel minus the one before.
struct SobelDifferences {
  vec4 x_low, x_high, y_low, y_high, z_low, z_high;
};

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

// The neighbours of a row's elements, before and after each.
PALPATE_TEXT vec4 beforeLow(float left, vec4 low) { return vec4(left, low[0], low[1], low[2]); }
PALPATE_TEXT vec4 afterLow(vec4 low, vec4 high) { return vec4(low[1], low[2], low[3], high[0]); }
PALPATE_TEXT vec4 beforeHigh(vec4 low, vec4 high) { return vec4(low[3], high[0], high[1], high[2]); }
PALPATE_TEXT vec4 afterHigh(vec4 high, float right) { return vec4(high[1], high[2], high[3], right); }

PALPATE_TEXT vec4 smoothLow(SobelRow row) {
  return smoothed3(beforeLow(row.left, row.low), row.low, afterLow(row.low, row.high));
}
PALPATE_TEXT vec4 smoothHigh(SobelRow row) {
  return smoothed3(beforeHigh(row.low, row.high), row.high, afterHigh(row.high, row.right));
}

PALPATE_TEXT SobelRow sixteenthOf(SobelRow row) {
  precise float left = row.left * 0.0625f;
  precise float right = row.right * 0.0625f;
  precise vec4 low = row.low * 0.0625f;
  precise vec4 high = row.high * 0.0625f;
  SobelRow scaled_row;
  scaled_row.left = left;
  scaled_row.right = right;
  scaled_row.low = low;
  scaled_row.high = high;
  return scaled_row;
}

// The slice of three rows in a sequence along j.
PALPATE_TEXT SobelSlice sobelSlice(SobelRow whole_before, SobelRow whole_middle, SobelRow whole_after) {
  const SobelRow before = sixteenthOf(whole_before);
  const SobelRow middle = sixteenthOf(whole_middle);
  const SobelRow after = sixteenthOf(whole_after);
  const vec4 before_low = smoothLow(before), before_high = smoothHigh(before);
  const vec4 middle_low = smoothLow(middle), middle_high = smoothHigh(middle);
  const vec4 after_low = smoothLow(after), after_high = smoothHigh(after);
  precise vec4 difference_low = after_low - before_low;
  precise vec4 difference_high = after_high - before_high;
  SobelSlice slice;
  slice.left = smoothed3(before.left, middle.left, after.left);
  slice.right = smoothed3(before.right, middle.right, after.right);
  slice.low = smoothed3(before.low, middle.low, after.low);
  slice.high = smoothed3(before.high, middle.high, after.high);
  slice.difference_low = difference_low;
  slice.difference_high = difference_high;
  slice.smooth_low = smoothed3(before_low, middle_low, after_low);
  slice.smooth_high = smoothed3(before_high, middle_high, after_high);
  return slice;
}

// The differences at the middle row, from three slices in a sequence along k.
PALPATE_TEXT SobelDifferences sobelDifferences(SobelSlice before, SobelSlice here, SobelSlice after) {
  const vec4 low = smoothed3(before.low, here.low, after.low);
  const vec4 high = smoothed3(before.high, here.high, after.high);
  const float left = smoothed3(before.left, here.left, after.left);
  const float right = smoothed3(before.right, here.right, after.right);
  precise vec4 x_low = afterLow(low, high) - beforeLow(left, low);
  precise vec4 x_high = afterHigh(high, right) - beforeHigh(low, high);
  precise vec4 z_low = after.smooth_low - before.smooth_low;
  precise vec4 z_high = after.smooth_high - before.smooth_high;
  SobelDifferences differences;
  differences.x_low = x_low;
  differences.x_high = x_high;
  differences.y_low = smoothed3(before.difference_low, here.difference_low, after.difference_low);
  differences.y_high = smoothed3(before.difference_high, here.difference_high, after.difference_high);
  differences.z_low = z_low;
  differences.z_high = z_high;
  return differences;
}

// The gradient from a difference, which is one-sided if a neighbour is missing.
PALPATE_TEXT float sobelGradient(float difference, uint c, uint last, float inv_2h_per_m, float inv_h_per_m) {
  precise float gradient = difference * (hasEitherSide(c, last, 1u) ? inv_2h_per_m : inv_h_per_m);
  return gradient;
}
