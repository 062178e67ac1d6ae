// SPDX-License-Identifier: Apache-2.0
#include "apps/serve/asking_rate.hpp"

#include <gtest/gtest.h>

#include "tests/servo/support/seeded.hpp"

namespace palpate {
namespace asking_rate_test {

constexpr std::int64_t kSecond_ns = 1'000'000'000;

TEST(AskingRate, AllowsSoManyAtOnce) {
  AskingRate rate(10, 4);
  for (int i = 0; i < 4; ++i) EXPECT_TRUE(rate.mayAsk(kSecond_ns)) << i;
  EXPECT_FALSE(rate.mayAsk(kSecond_ns));
  EXPECT_FALSE(rate.mayAsk(kSecond_ns + kSecond_ns / 20));
  EXPECT_TRUE(rate.mayAsk(kSecond_ns + kSecond_ns / 10));
}

// However long nobody asked.
TEST(AskingRate, APauseIsNotSavedUp) {
  AskingRate rate(10, 4);
  EXPECT_TRUE(rate.mayAsk(kSecond_ns));
  for (int i = 0; i < 4; ++i) EXPECT_TRUE(rate.mayAsk(1000 * kSecond_ns)) << i;
  EXPECT_FALSE(rate.mayAsk(1000 * kSecond_ns));
}

// In any length of time no more than that many at once and so many a second come through, and hardly fewer.
TEST(AskingRate, HoldsInTheLongRun) {
  Seeded random(3);
  AskingRate rate(100, 20);
  std::int64_t now_ns = 1;
  double asked = 0;
  while (now_ns < 60 * kSecond_ns) {
    now_ns += 1 + random.pick(2'000'000);  // some 1000 times a second
    asked += rate.mayAsk(now_ns) ? 1 : 0;
  }
  const double allowed = 20 + 100 * static_cast<double>(now_ns) / 1e9;
  EXPECT_LE(asked, allowed);
  EXPECT_GE(asked, 0.99 * allowed);
}

}  // namespace asking_rate_test
}  // namespace palpate
