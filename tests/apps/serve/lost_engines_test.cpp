// SPDX-License-Identifier: Apache-2.0
#include "apps/serve/lost_engines.hpp"

#include <gtest/gtest.h>

namespace palpate {
namespace lost_engines_test {

TEST(LostEngines, TwentyInAMinuteAreBorne) {
  LostEngines lost;
  for (std::size_t i = 0; i < LostEngines::kMost; ++i) EXPECT_TRUE(lost.mayGoOn(1000)) << i;
  EXPECT_FALSE(lost.mayGoOn(1000 + LostEngines::kWithin_ns));
}

// Of any twenty-one, the first and the last are more than a minute apart.
TEST(LostEngines, OneNowAndThenIsBorneForEver) {
  LostEngines lost;
  for (std::int64_t i = 0; i < 1000; ++i) EXPECT_TRUE(lost.mayGoOn(i * (LostEngines::kWithin_ns / 20 + 1))) << i;
}

TEST(LostEngines, ThoseLongAgoAreForgotten) {
  LostEngines lost;
  for (int i = 0; i < 21; ++i) static_cast<void>(lost.mayGoOn(0));
  EXPECT_FALSE(lost.mayGoOn(1));
  EXPECT_TRUE(lost.mayGoOn(LostEngines::kWithin_ns + 2));
}

}  // namespace lost_engines_test
}  // namespace palpate
