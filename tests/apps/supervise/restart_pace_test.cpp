// SPDX-License-Identifier: Apache-2.0
// The truth is the rule in restart_pace.hpp, with its default numbers. The times are given, none is measured.
#include "apps/supervise/restart_pace.hpp"

#include <vector>

#include <gmock/gmock.h>

namespace palpate {
namespace restart_pace_test {

using testing::DoubleEq;
using testing::Eq;
using testing::Optional;

TEST(RestartPace, WaitsTwiceAsLongEachTimeUpToALimit) {
  RestartPace pace{RestartLimits{}};
  double died_s = 100;
  for (const double wait_s : {0.0, 0.1, 0.2, 0.4, 0.8, 1.6, 3.2, 5.0, 5.0}) {
    died_s += 20;  // so none is given up
    EXPECT_THAT(pace.afterDeath(died_s, 2), Optional(DoubleEq(wait_s)));
  }
}

TEST(RestartPace, IsAtOnceAgainAfterALongLife) {
  RestartPace pace{RestartLimits{}};
  EXPECT_THAT(pace.afterDeath(2, 2), Optional(0.0));
  EXPECT_THAT(pace.afterDeath(4, 2), Optional(0.1));
  EXPECT_THAT(pace.afterDeath(13.9, 9.9), Optional(0.2));
  EXPECT_THAT(pace.afterDeath(23.9, 10), Optional(0.0));
  EXPECT_THAT(pace.afterDeath(26, 2), Optional(0.1));
}

TEST(RestartPace, GivesUpAfterFiveShortLives) {
  RestartPace pace{RestartLimits{}};
  for (const double died_s : {1.0, 2.0, 3.0, 4.0}) EXPECT_TRUE(pace.afterDeath(died_s, 0.9)) << died_s;
  EXPECT_THAT(pace.afterDeath(5, 0.9), Eq(std::nullopt));
}

TEST(RestartPace, ALifeThatIsNotShortBreaksTheRow) {
  RestartPace pace{RestartLimits{}};
  for (const double died_s : {1.0, 2.0, 3.0, 4.0}) EXPECT_TRUE(pace.afterDeath(died_s, 0.5)) << died_s;
  EXPECT_TRUE(pace.afterDeath(5, 1));
  for (const double died_s : {6.0, 7.0, 8.0, 9.0}) EXPECT_TRUE(pace.afterDeath(died_s, 0.5)) << died_s;
  EXPECT_FALSE(pace.afterDeath(9.5, 0.5));
}

TEST(RestartPace, ShortLivesThatEndedLongAgoDoNotCount) {
  RestartPace pace{RestartLimits{}};
  for (int n = 0; n < 20; ++n) EXPECT_TRUE(pace.afterDeath(2.6 * n, 0.5)) << n;  // five take 10.4 s
}

}  // namespace restart_pace_test
}  // namespace palpate
