// SPDX-License-Identifier: Apache-2.0
// shaders/filter_median.math.glsl: the median of 27 ranks (the 14th), from three columns of nine. Each column is sorted
// once and serves three medians. The two columns that neighbouring medians share are merged once and serve both. The
// result is exact, since it comes from min and max of whole numbers alone. Read by GLSL and by C++
// (shaders/kernel_text.hpp).

#ifndef MEDIAN_RANK
#define MEDIAN_RANK int  // tests also compile the networks for words of zeros and ones
#endif

#define SORT_PAIR(a, b)                        \
  {                                            \
    const MEDIAN_RANK lower = min(v[a], v[b]); \
    v[b] = max(v[a], v[b]);                    \
    v[a] = lower;                              \
  }

// A network of 25 exchanges, the fewest that sort nine (Codish, Cruz-Filipe, Frank, Schneider-Kamp 2014).
// clang-format off
PALPATE_TEXT void sortNine(PALPATE_INOUT_ARRAY(MEDIAN_RANK, v, 9)) {
  SORT_PAIR(0, 3) SORT_PAIR(1, 7) SORT_PAIR(2, 5) SORT_PAIR(4, 8) SORT_PAIR(0, 7) SORT_PAIR(2, 4) SORT_PAIR(3, 8)
  SORT_PAIR(5, 6) SORT_PAIR(0, 2) SORT_PAIR(1, 3) SORT_PAIR(4, 5) SORT_PAIR(7, 8) SORT_PAIR(1, 4) SORT_PAIR(3, 6)
  SORT_PAIR(5, 7) SORT_PAIR(0, 1) SORT_PAIR(2, 4) SORT_PAIR(3, 5) SORT_PAIR(6, 8) SORT_PAIR(2, 3) SORT_PAIR(4, 5)
  SORT_PAIR(6, 7) SORT_PAIR(1, 2) SORT_PAIR(3, 4) SORT_PAIR(5, 6)
}

// The middle ten of two sorted nines, sorted. This is Batcher's odd-even merge without the exchanges that only the
// other eight need. The four lowest of the eighteen have fourteen above them, so none of them is the 14th of 27. The
// same holds for the four highest.
PALPATE_TEXT void middleTen(PALPATE_IN_ARRAY(MEDIAN_RANK, a, 9), PALPATE_IN_ARRAY(MEDIAN_RANK, b, 9),
                            PALPATE_INOUT_ARRAY(MEDIAN_RANK, m, 10)) {
  MEDIAN_RANK v[18];
  for (int i = 0; i < 9; ++i) {
    v[i] = a[i];
    v[i + 9] = b[i];
  }
  SORT_PAIR(0, 9) SORT_PAIR(8, 17) SORT_PAIR(8, 9) SORT_PAIR(4, 13) SORT_PAIR(4, 8) SORT_PAIR(13, 9) SORT_PAIR(2, 11)
  SORT_PAIR(6, 15) SORT_PAIR(6, 11) SORT_PAIR(2, 4) SORT_PAIR(6, 8) SORT_PAIR(11, 13) SORT_PAIR(15, 9)
  SORT_PAIR(1, 10) SORT_PAIR(5, 14) SORT_PAIR(5, 10) SORT_PAIR(3, 12) SORT_PAIR(7, 16) SORT_PAIR(7, 12)
  SORT_PAIR(3, 5) SORT_PAIR(7, 10) SORT_PAIR(12, 14) SORT_PAIR(3, 4) SORT_PAIR(5, 6) SORT_PAIR(7, 8) SORT_PAIR(10, 11)
  SORT_PAIR(12, 13) SORT_PAIR(14, 15)
  m[0] = v[4]; m[1] = v[5]; m[2] = v[6]; m[3] = v[7]; m[4] = v[8];
  m[5] = v[10]; m[6] = v[11]; m[7] = v[12]; m[8] = v[13]; m[9] = v[14];
}
// clang-format on
#undef SORT_PAIR

// The tenth lowest of a sorted ten and a sorted nine together. The ten lowest of all are the first n of one list and
// the first 10 - n of the other. Of all such choices, theirs has the lowest maximum.
PALPATE_TEXT MEDIAN_RANK tenthOf(PALPATE_IN_ARRAY(MEDIAN_RANK, m, 10), PALPATE_IN_ARRAY(MEDIAN_RANK, c, 9)) {
  MEDIAN_RANK tenth = m[9];
  for (int i = 0; i < 9; ++i) tenth = min(tenth, max(m[8 - i], c[i]));
  return tenth;
}
