// SPDX-License-Identifier: Apache-2.0
// shaders/filter_rank.math.glsl: densities as whole numbers in the same order, -0 before +0, so that picking one of
// many needs no comparison of floats: lowest and highest are exact and do not depend on the order of picking. Read by
// GLSL and by C++ (shaders/kernel_text.hpp).

// The bits of a float order as a signed number does but for negative ones, which run backwards. Its own inverse.
PALPATE_TEXT int turnedBits(int bits) { return bits ^ ((bits >> 31) & 0x7fffffff); }

PALPATE_TEXT int rankOf(float density) { return turnedBits(floatBitsToInt(density)); }
PALPATE_TEXT float densityOf(int rank) { return intBitsToFloat(turnedBits(rank)); }

PALPATE_TEXT ivec4 rankOf(vec4 density) {
  return ivec4(rankOf(density[0]), rankOf(density[1]), rankOf(density[2]), rankOf(density[3]));
}
PALPATE_TEXT vec4 densityOf(ivec4 rank) {
  return vec4(densityOf(rank[0]), densityOf(rank[1]), densityOf(rank[2]), densityOf(rank[3]));
}

// The middle between two ranks, rounded down; their sum might not fit.
PALPATE_TEXT int halfway(int low, int high) { return (low & high) + ((low ^ high) >> 1); }
