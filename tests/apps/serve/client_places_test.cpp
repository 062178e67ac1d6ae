// SPDX-License-Identifier: Apache-2.0
#include "apps/serve/client_places.hpp"

#include <vector>

#include <gtest/gtest.h>

#include "tests/servo/support/seeded.hpp"

namespace palpate {
namespace client_places_test {

using Guest = ClientPlaces::Guest;
using Entry = ClientPlaces::Entry;
constexpr std::int64_t kSecond_ns = 1'000'000'000, kNow_ns = 1000 * kSecond_ns;

std::int64_t ago(double seconds) {
  return kNow_ns - static_cast<std::int64_t>(seconds * 1e9);
}

TEST(ClientPlaces, AreForSoManyAndAFewOnTrial) {
  std::vector<Guest> guests;
  for (std::size_t i = 0; i < ClientPlaces::kPlaces; ++i) {
    EXPECT_EQ(ClientPlaces::entryOf(guests), Entry::kWithAPlace);
    guests.push_back({kNow_ns});
  }
  for (std::size_t i = 0; i < ClientPlaces::kOnTrial; ++i) {
    EXPECT_EQ(ClientPlaces::entryOf(guests), Entry::kOnTrial);
    guests.push_back({.heard_ns = kNow_ns, .on_trial = true});
  }
  EXPECT_EQ(ClientPlaces::entryOf(guests), Entry::kNotYet);
  guests.pop_back();
  EXPECT_EQ(ClientPlaces::entryOf(guests), Entry::kOnTrial);
  guests.erase(guests.begin());
  EXPECT_EQ(ClientPlaces::entryOf(guests), Entry::kWithAPlace);
}

// Against looking through all of them, with random guests.
TEST(ClientPlaces, TheIdlestOfAFullHouseMakesRoomAndNobodyElse) {
  Seeded random(4);
  int made = 0, none = 0;
  for (int trial = 0; trial < 2000; ++trial) {
    std::vector<Guest> guests;
    const int count = 28 + random.pick(12);
    int places = 0;
    double idlest_s = -1;
    for (int i = 0; i < count; ++i) {
      const double idle_s = random.between(0, 14);
      guests.push_back({ago(idle_s), random.pick(3) == 0, random.pick(6) == 0});
      places += guests.back().on_trial ? 0 : 1;
      if (!guests.back().on_trial && !guests.back().is_busy && idle_s >= ClientPlaces::kIdle_s)
        idlest_s = std::max(idlest_s, idle_s);
    }
    const auto found = ClientPlaces::outstayed(guests, kNow_ns);
    const bool is_full = places >= static_cast<int>(ClientPlaces::kPlaces);
    ASSERT_EQ(found.has_value(), is_full && idlest_s > 0) << trial;
    (found ? made : none) += 1;
    if (found) {
      ASSERT_EQ(guests[*found].heard_ns, ago(idlest_s)) << trial;
    }
  }
  EXPECT_GT(made, 100);
  EXPECT_GT(none, 100);
}

TEST(ClientPlaces, ATrialEndsUnlessAnAnswerIsUnderWay) {
  EXPECT_FALSE(ClientPlaces::trialIsOver({.heard_ns = ago(0.4), .on_trial = true}, kNow_ns));
  EXPECT_TRUE(ClientPlaces::trialIsOver({.heard_ns = ago(0.6), .on_trial = true}, kNow_ns));
  EXPECT_FALSE(ClientPlaces::trialIsOver({.heard_ns = ago(60), .is_busy = true, .on_trial = true}, kNow_ns));
  EXPECT_FALSE(ClientPlaces::trialIsOver({.heard_ns = ago(60)}, kNow_ns));
}

}  // namespace client_places_test
}  // namespace palpate
