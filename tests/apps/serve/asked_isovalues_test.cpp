// SPDX-License-Identifier: Apache-2.0
#include "apps/serve/asked_isovalues.hpp"

#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "tests/servo/support/seeded.hpp"

namespace palpate {
namespace asked_isovalues_test {

const Error kRefusal(Error::Code::kBadInput, "isovalue", "no surface has it", "give another");

// What became of each that was asked for, in the order of asking: 'w' it waits, 'd' it is done, 'r' it is refused.
struct Asker {
  AskedIsovalues asked;
  std::string became;
  void ask(double isovalue) {
    const std::size_t index = became.size();
    became += 'w';
    asked.add(isovalue, [this, index](const std::optional<Error>& refusal) {
      EXPECT_EQ(became[index], 'w') << "answered twice";
      if (refusal) {
        EXPECT_EQ(refusal->reason(), kRefusal.reason());
      }
      became[index] = refusal ? 'r' : 'd';
    });
  }
};

TEST(AskedIsovalues, ASecondOneIsNotAnsweredWithTheFirst) {
  Asker asker;
  asker.ask(1);
  asker.ask(2);
  asker.asked.reached(1);
  EXPECT_EQ(asker.became, "dw");
  asker.asked.reached(2);
  EXPECT_EQ(asker.became, "dd");
}

TEST(AskedIsovalues, OneThatWasOvertakenIsAnsweredWithTheNewer) {
  Asker asker;
  asker.ask(1);
  asker.ask(2);
  asker.ask(3);
  asker.asked.reached(2);
  EXPECT_EQ(asker.became, "ddw");
}

TEST(AskedIsovalues, WhatNobodyAskedForAnswersNobody) {
  Asker asker;
  asker.asked.reached(1);
  EXPECT_FALSE(asker.asked.refuse(kRefusal));
  asker.ask(2);
  asker.asked.reached(1);
  EXPECT_EQ(asker.became, "w");
}

TEST(AskedIsovalues, ARefusalIsNotForTheOneThatIsKept) {
  Asker asker;
  for (const double isovalue : {1, 2, 1, 2}) asker.ask(isovalue);
  EXPECT_TRUE(asker.asked.refuse(kRefusal, 2));
  EXPECT_EQ(asker.became, "rwrw");
  EXPECT_FALSE(asker.asked.refuse(kRefusal, 2));
  EXPECT_TRUE(asker.asked.refuse(kRefusal));
  EXPECT_EQ(asker.became, "rrrr");
}

// Somebody who is answered asks again at once.
TEST(AskedIsovalues, WhoIsAnsweredMayAsk) {
  AskedIsovalues asked;
  int answers = 0;
  asked.add(1, [&](const auto&) {
    ++answers;
    asked.add(2, [&](const auto&) { ++answers; });
  });
  asked.reached(1);
  EXPECT_EQ(answers, 1);
  asked.reached(2);
  EXPECT_EQ(answers, 2);
}

// Held against the rule, written down once more over the whole list.
TEST(AskedIsovalues, AnySequenceFollowsTheRule) {
  Seeded random(11);
  for (int run = 0; run < 300; ++run) {
    Asker asker;
    std::vector<double> isovalues;
    std::string expected;
    for (int step = 0; step < 30; ++step) {
      const double isovalue = random.pick(4);
      switch (random.pick(3)) {
        case 0:
          asker.ask(isovalue);
          isovalues.push_back(isovalue);
          expected += 'w';
          break;
        case 1: {
          asker.asked.reached(isovalue);
          bool is_before = false;
          for (std::size_t i = expected.size(); i-- > 0;) {
            is_before = is_before || (expected[i] == 'w' && isovalues[i] == isovalue);
            if (is_before && expected[i] == 'w') expected[i] = 'd';
          }
          break;
        }
        default: {
          bool any = false;
          for (std::size_t i = 0; i < expected.size(); ++i) {
            if (expected[i] != 'w' || isovalues[i] == isovalue) continue;
            expected[i] = 'r';
            any = true;
          }
          EXPECT_EQ(asker.asked.refuse(kRefusal, isovalue), any);
        }
      }
      ASSERT_EQ(asker.became, expected);
    }
  }
}

}  // namespace asked_isovalues_test
}  // namespace palpate
