// SPDX-License-Identifier: Apache-2.0
// shaders/filter_rank.math.glsl: ranks are densities as whole numbers in the same order, -0 before +0. Comparing ranks
// needs no comparison of floats. So lowest and highest are exact and do not depend on the order of comparisons. Read by
// GLSL and by C++ (shaders/kernel_text.hpp).

#define RANK_LOWEST int(0x80000000)
#define RANK_HIGHEST 0x7fffffff

// The bits of floats, read as signed numbers, order as the floats do, but negative ones in reverse. This reverses
// those. It is its own inverse.
PALPATE_TEXT int turnedBits(int bits) { return bits ^ ((bits >> 31) & 0x7fffffff); }

PALPATE_TEXT int rankOf(float density) { return turnedBits(floatBitsToInt(density)); }
PALPATE_TEXT float densityOf(int rank) { return intBitsToFloat(turnedBits(rank)); }

PALPATE_TEXT ivec4 rankOf(vec4 density) {
  return ivec4(rankOf(density[0]), rankOf(density[1]), rankOf(density[2]), rankOf(density[3]));
}
PALPATE_TEXT vec4 densityOf(ivec4 rank) {
  return vec4(densityOf(rank[0]), densityOf(rank[1]), densityOf(rank[2]), densityOf(rank[3]));
}

// extremeOf(): the higher or the lower of two, as `which` asks (EXTREME_...). noExtreme(): a rank that loses to every
// other.
PALPATE_TEXT int extremeOf(uint which, int a, int b) { return which == EXTREME_HIGHEST ? max(a, b) : min(a, b); }
PALPATE_TEXT ivec4 extremeOf(uint which, ivec4 a, ivec4 b) { return which == EXTREME_HIGHEST ? max(a, b) : min(a, b); }
PALPATE_TEXT int noExtreme(uint which) { return which == EXTREME_HIGHEST ? RANK_LOWEST : RANK_HIGHEST; }

// Search by halving: the range that still contains the sought rank (the n-th of many).
struct RankRange {
  int lowest, highest;
};

PALPATE_TEXT RankRange noRange() {
  RankRange range;
  range.lowest = RANK_HIGHEST;
  range.highest = RANK_LOWEST;
  return range;
}

PALPATE_TEXT RankRange widened(RankRange range, int rank) {
  RankRange wider;
  wider.lowest = min(range.lowest, rank);
  wider.highest = max(range.highest, rank);
  return wider;
}

// The middle between two ranks, rounded down. Their sum might overflow, so this does not form it.
PALPATE_TEXT int halfway(int low, int high) { return (low & high) + ((low ^ high) >> 1); }

// The half that holds the rank at `place` (1: the lowest), if `count` ranks are at or below the middle.
PALPATE_TEXT RankRange halved(RankRange range, int count, int place) {
  const int middle = halfway(range.lowest, range.highest);
  RankRange half_range;
  half_range.lowest = count >= place ? range.lowest : middle + 1;
  half_range.highest = count >= place ? middle : range.highest;
  return half_range;
}
