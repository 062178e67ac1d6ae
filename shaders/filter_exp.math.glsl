// SPDX-License-Identifier: Apache-2.0
// shaders/filter_exp.math.glsl: an exponential made of + - * and bit operations alone. The drivers' own differ from
// device to device, by 3 ULP and more. Read by GLSL and by C++ (shaders/kernel_text.hpp).

// 2^p for p <= 0, within 2 ULP; 0 below p = -125 and for NaN. p is split into a whole n and |r| <= 1/2, both exact. 2^r
// is a polynomial through six Chebyshev nodes, off by 0.16 * 2^-24 of the value at most. 2^n goes into the exponent's
// bits.
PALPATE_TEXT float exp2Below(float p) {
  const float q = p >= -125.0f ? p : -125.0f;
  const float n = floor(q + 0.5f);
  precise float r = q - n;
  precise float t = 1.54531634e-4f * r;
  t = t + 1.33908633e-3f;
  t = t * r;
  t = t + 9.61808302e-3f;
  t = t * r;
  t = t + 5.55035695e-2f;
  t = t * r;
  t = t + 2.40226507e-1f;
  t = t * r;
  t = t + 6.93147182e-1f;
  t = t * r;
  t = t + 1.0f;
  const float power = uintBitsToFloat(floatBitsToUint(t) - (uint(int(-n)) << 23));
  return p >= -125.0f ? power : 0.0f;
}

// exp(-s^2). Rounding s^2, log2(e) and their product changes the exponent by 3 * 2^-24 of itself at most.
PALPATE_TEXT float gaussianOf(float s) {
  precise float square = s * s;
  precise float p = -1.44269504f * square;
  return exp2Below(p);
}
