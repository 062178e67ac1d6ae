// SPDX-License-Identifier: Apache-2.0
// Entrants that say what they took: no clock is asked.
#include "apps/bench/turns.hpp"

#include <gmock/gmock.h>

#include "base/error.hpp"

namespace palpate {
namespace turns_test {

using testing::ElementsAre;
using testing::HasSubstr;

class TurnsTest : public testing::Test {
 protected:
  Contender entrant(const std::string& library, double wall_ms) {
    return {library, "way", [this, library, wall_ms] {
              order_ += library;
              return RunCost{wall_ms, 2 * wall_ms};
            }};
  }
  std::string order_;
};

TEST_F(TurnsTest, GoRoundAndEveryoneBeginsOnce) {
  Turns turns({.most_rounds = 3, .budget_s = 100, .longest_s = 100});
  const auto outcomes = turns.take("job", 10, {entrant("a", 1), entrant("b", 2), entrant("c", 3)});
  EXPECT_EQ(order_,
            "abc"
            "abc"
            "bca"
            "cab");  // warm-up, three rounds
  ASSERT_EQ(outcomes.size(), 3U);
  EXPECT_EQ(outcomes[1].library, "b");
  EXPECT_THAT(outcomes[1].wall_ms, ElementsAre(2, 2, 2));
  EXPECT_THAT(outcomes[1].cpu_ms, ElementsAre(4, 4, 4));
}

TEST_F(TurnsTest, WhoIsSlowHasFewerAndItsFirstCounts) {
  Turns turns({.most_rounds = 4, .budget_s = 5, .longest_s = 100});
  const auto outcomes = turns.take("job", 10, {entrant("a", 1), entrant("b", 2000), entrant("c", 9000)});
  EXPECT_EQ(outcomes[0].wall_ms.size(), 4U);
  EXPECT_EQ(outcomes[1].wall_ms.size(), 2U);  // 5 s hold two of its runs
  EXPECT_EQ(outcomes[2].wall_ms.size(), 1U);
  EXPECT_EQ(order_,
            "abc"
            "ab"
            "a"
            "a"
            "a");
}

TEST_F(TurnsTest, WhoWouldTakeTooLongIsLeftOut) {
  Turns turns({.most_rounds = 1, .budget_s = 1, .longest_s = 20});
  EXPECT_EQ(turns.take("job", 100, {entrant("a", 2000)})[0].left_out, "");
  order_.clear();
  const TurnsOutcome outcome = turns.take("job", 800, {entrant("a", 2000)})[0];  // eight times the voxels: 32 s
  EXPECT_THAT(outcome.left_out, HasSubstr("some 32 s"));
  EXPECT_TRUE(outcome.wall_ms.empty());
  EXPECT_EQ(order_, "");
  Contender anyway = entrant("a", 2000);
  anyway.own = true;
  EXPECT_EQ(turns.take("job", 800, {anyway})[0].wall_ms.size(), 1U);
  EXPECT_EQ(order_, "aa");  // and the first run of its own was only to warm up
  EXPECT_EQ(turns.take("another job", 800, {entrant("a", 2000)})[0].left_out, "");
}

TEST_F(TurnsTest, WhoFailsIsLeftOutInItsOwnWords) {
  Turns turns({.most_rounds = 2});
  const Contender fails{"f", "way",
                        []() -> RunCost { throw Error(Error::Code::kOutOfMemory, "ITK", "no memory", "buy some"); }};
  const auto outcomes = turns.take("job", 10, {fails, entrant("a", 1)});
  EXPECT_THAT(outcomes[0].left_out, HasSubstr("no memory"));
  EXPECT_EQ(outcomes[1].wall_ms.size(), 2U);
}

TEST_F(TurnsTest, EndsWhenThePersonSaysSo) {
  Turns turns({.most_rounds = 2});
  const Contender stopped{"s", "way", []() -> RunCost {
                            throw Error(Error::Code::kCancelled, "palpate bench", "stopped by the user", "none");
                          }};
  const std::vector<Contender> entrants(1, stopped);  // by name: GCC 12 frees a braced list twice when its call throws
  EXPECT_THROW(static_cast<void>(turns.take("job", 10, entrants)), Error);
}

}  // namespace turns_test
}  // namespace palpate
