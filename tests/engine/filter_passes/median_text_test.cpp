// SPDX-License-Identifier: Apache-2.0
// The text of the median kernel, compiled for the CPU. A network of exchanges that sorts, or picks a place of, every
// sequence of noughts and ones does so for all values (the 0-1 principle: Knuth, The Art of Computer Programming
// 3, 5.3.4).
#include <algorithm>
#include <bit>
#include <vector>

#include <gtest/gtest.h>

#include "shaders/kernel_text.hpp"

namespace palpate {
namespace median_text_test {

// The networks once more, for a word of noughts and ones: the lowest of two is 1 where both are, the highest where one
// is.
namespace by_64 {
struct Noughts {
  std::uint64_t ones = 0;
};
Noughts min(Noughts a, Noughts b) {
  return {a.ones & b.ones};
}
Noughts max(Noughts a, Noughts b) {
  return {a.ones | b.ones};
}
#define MEDIAN_RANK Noughts
#include "shaders/filter_median_wide.math.glsl"
#undef MEDIAN_RANK
}  // namespace by_64

// A sorted list of noughts, then ones.
template <std::size_t kCount>
void fillSorted(int (&list)[kCount], std::size_t ones) {
  for (std::size_t i = 0; i < kCount; ++i) list[i] = i + ones >= kCount ? 1 : 0;
}

TEST(MedianText, SortsEveryNine) {
  for (unsigned pattern = 0; pattern < 512; ++pattern) {
    int nine[9];
    for (unsigned i = 0; i < 9; ++i) nine[i] = static_cast<int>(pattern >> i & 1U);
    kernel_text::sortNine(nine);
    EXPECT_TRUE(std::is_sorted(std::begin(nine), std::end(nine))) << pattern;
    EXPECT_EQ(std::count(std::begin(nine), std::end(nine), 1), std::popcount(pattern));
  }
}

TEST(MedianText, FindsTheMiddleTen) {
  for (std::size_t in_a = 0; in_a <= 9; ++in_a) {
    for (std::size_t in_b = 0; in_b <= 9; ++in_b) {
      int a[9], b[9], middle[10], all[18];
      fillSorted(a, in_a);
      fillSorted(b, in_b);
      fillSorted(all, in_a + in_b);
      kernel_text::middleTen(a, b, middle);
      for (int i = 0; i < 10; ++i) EXPECT_EQ(middle[i], all[i + 4]) << in_a << " " << in_b << ": " << i;
    }
  }
}

TEST(MedianText, PicksTheTenthOfTenAndNine) {
  for (std::size_t in_ten = 0; in_ten <= 10; ++in_ten) {
    for (std::size_t in_nine = 0; in_nine <= 9; ++in_nine) {
      int ten[10], nine[9], all[19];
      fillSorted(ten, in_ten);
      fillSorted(nine, in_nine);
      fillSorted(all, in_ten + in_nine);
      EXPECT_EQ(kernel_text::tenthOf(ten, nine), all[9]);
    }
  }
}

// All 2^25 patterns, 64 at a time.
TEST(MedianText, SortsEveryColumnOf25) {
  // Of the lowest six of a pattern's bits: over 64 patterns in a row.
  constexpr std::uint64_t kLow[] = {0xaaaaaaaaaaaaaaaa, 0xcccccccccccccccc, 0xf0f0f0f0f0f0f0f0,
                                    0xff00ff00ff00ff00, 0xffff0000ffff0000, 0xffffffff00000000};
  for (std::uint64_t high = 0; high < (1U << 19U); ++high) {
    by_64::Noughts column[25];
    for (std::size_t i = 0; i < 25; ++i)
      column[i].ones = i < 6 ? kLow[i] : (high >> (i - 6) & 1U) != 0 ? ~std::uint64_t{0} : 0;
    by_64::sortColumn(column);
    std::uint64_t unsorted = 0;
    for (std::size_t i = 1; i < 25; ++i) unsorted |= column[i - 1].ones & ~column[i].ones;
    ASSERT_EQ(unsorted, 0U) << high;
  }
}

TEST(MedianText, MergesColumnsAndFindsTheMiddleOfFour) {
  for (std::size_t in_a = 0; in_a <= 50; ++in_a) {
    for (std::size_t in_b = 0; in_b <= 50; ++in_b) {
      int a[50], b[50], middle[26], all[100];
      fillSorted(a, in_a);
      fillSorted(b, in_b);
      fillSorted(all, in_a + in_b);
      kernel_text::middleOfFour(a, b, middle);
      EXPECT_TRUE(std::equal(std::begin(middle), std::end(middle), all + 37)) << in_a << " " << in_b;
      if (in_a > 25 || in_b > 25) continue;
      int half_a[25], half_b[25], merged[50];
      fillSorted(half_a, in_a);
      fillSorted(half_b, in_b);
      kernel_text::mergeColumns(half_a, half_b, merged);
      fillSorted(a, in_a + in_b);
      EXPECT_TRUE(std::equal(std::begin(merged), std::end(merged), a)) << in_a << " " << in_b;
    }
  }
}

TEST(MedianText, PicksTheMiddleOf26And25) {
  for (std::size_t in_a = 0; in_a <= 26; ++in_a) {
    for (std::size_t in_b = 0; in_b <= 25; ++in_b) {
      int a[26], b[25], all[51];
      fillSorted(a, in_a);
      fillSorted(b, in_b);
      fillSorted(all, in_a + in_b);
      EXPECT_EQ(kernel_text::middleOf(a, b), all[25]);
    }
  }
}

TEST(RankText, RanksStandAsTheirDensitiesDo) {
  const float ordered[] = {-3.4e38F, -1e30F, -1.0F,  -1e-40F, -1e-45F, -0.0F,
                           0.0F,     1e-45F, 1e-40F, 1.0F,    1e30F,   3.4e38F};
  for (std::size_t i = 0; i < std::size(ordered); ++i) {
    const int rank = kernel_text::rankOf(ordered[i]);
    if (i > 0) {
      EXPECT_LT(kernel_text::rankOf(ordered[i - 1]), rank) << ordered[i];
    }
    EXPECT_EQ(std::bit_cast<std::uint32_t>(kernel_text::densityOf(rank)), std::bit_cast<std::uint32_t>(ordered[i]));
  }
}

TEST(RankText, HalfwayRoundsDownAndDoesNotOverflow) {
  constexpr int kMost = 0x7fffffff;
  EXPECT_EQ(kernel_text::halfway(2, 5), 3);
  EXPECT_EQ(kernel_text::halfway(-5, -2), -4);
  EXPECT_EQ(kernel_text::halfway(-1, 0), -1);
  EXPECT_EQ(kernel_text::halfway(kMost - 1, kMost), kMost - 1);
  EXPECT_EQ(kernel_text::halfway(-kMost - 1, kMost), -1);
}

}  // namespace median_text_test
}  // namespace palpate
