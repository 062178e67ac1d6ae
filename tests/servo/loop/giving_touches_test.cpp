// SPDX-License-Identifier: Apache-2.0
// Touches made by hand: each takes 1 mJ and gives back that and a share more.
#include "servo/loop/giving_touches.hpp"

#include <cmath>

#include <gtest/gtest.h>

namespace palpate {
namespace giving_touches_test {

class Tapping {
 public:
  Tapping() : touches_(0, 0) {}

  // A touch of four ticks, the first of which stores; after a flight. Returns whether it was the last of a fed series.
  bool tap(double share, double flight_s = 0.1, double peak_N = 1, double stored_mJ = 1) {
    time_s_ += flight_s;
    const double begin_mJ = energy_mJ_;
    const double change_mJ[] = {0, 1, -1 - share, -1 - share};
    for (const double mJ : change_mJ) tick(begin_mJ + stored_mJ * (mJ < 0 ? -share : mJ), peak_N);
    energy_mJ_ = begin_mJ - stored_mJ * share;
    return tick(energy_mJ_, 0);
  }
  void edit() { ++edits_; }

 private:
  bool tick(double energy_mJ, double force_N) {
    time_s_ += 1e-3;
    TickRecord record;
    record.time_s = time_s_;
    record.energy_J = energy_mJ * 1e-3;
    record.force_W[0] = force_N;
    record.in_contact = force_N > 0;
    record.edit_version = edits_;
    return touches_.add(record);
  }

  GivingTouches touches_;
  double time_s_ = 0, energy_mJ_ = 0;
  std::uint64_t edits_ = 0;
};

TEST(GivingTouches, TheTenthOfASeriesIsNoticed) {
  Tapping tapping;
  for (int i = 1; i <= 9; ++i) EXPECT_FALSE(tapping.tap(0.02)) << i;
  EXPECT_TRUE(tapping.tap(0.02));
  EXPECT_TRUE(tapping.tap(0.02));
}

TEST(GivingTouches, ALittleIsNoGift) {
  static_assert(GivingTouches::kGiftShare == 0.01);
  Tapping tapping;
  for (int i = 0; i < 30; ++i) EXPECT_FALSE(tapping.tap(0.0099)) << i;
  for (int i = 0; i < 19; ++i) static_cast<void>(tapping.tap(0.0101));
  EXPECT_TRUE(tapping.tap(0.0101));
}

TEST(GivingTouches, TouchesThatTakeCountAgainstThoseThatGive) {
  Tapping even, uneven;
  for (int i = 0; i < 30; ++i) {
    EXPECT_FALSE(even.tap(i % 2 == 0 ? 0.05 : -0.05)) << i;
    static_cast<void>(uneven.tap(i % 2 == 0 ? 0.08 : -0.02));
  }
  EXPECT_TRUE(uneven.tap(0.08));
}

TEST(GivingTouches, ALongFlightBeginsAnew) {
  static_assert(GivingTouches::kLongestFlight_s == 1);
  Tapping tapping;
  for (int i = 0; i < 9; ++i) static_cast<void>(tapping.tap(0.1));
  EXPECT_FALSE(tapping.tap(0.1, 1.01));
  for (int i = 0; i < 8; ++i) EXPECT_FALSE(tapping.tap(0.1, 0.99)) << i;
  EXPECT_TRUE(tapping.tap(0.1));
}

TEST(GivingTouches, AnEditBeginsAnew) {
  Tapping tapping;
  for (int i = 0; i < 9; ++i) static_cast<void>(tapping.tap(0.1));
  tapping.edit();
  EXPECT_FALSE(tapping.tap(0.1));
  for (int i = 0; i < 9; ++i) EXPECT_FALSE(tapping.tap(0.1)) << i;
  EXPECT_TRUE(tapping.tap(0.1));
}

// A tool that lands stores less with each bounce: ten times less within the series, though each gives 5 %.
TEST(GivingTouches, BouncesThatDieAwayAreALanding) {
  Tapping landing;
  for (int i = 0; i < 40; ++i) EXPECT_FALSE(landing.tap(0.05, 0.05, 1, std::pow(0.9, i))) << i;
  Tapping lasting;
  for (int i = 0; i < 19; ++i) static_cast<void>(lasting.tap(0.05, 0.05, 1, std::pow(0.98, i)));
  EXPECT_TRUE(lasting.tap(0.05, 0.05, 1, std::pow(0.98, 19)));
}

}  // namespace giving_touches_test
}  // namespace palpate
