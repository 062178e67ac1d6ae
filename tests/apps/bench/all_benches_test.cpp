// SPDX-License-Identifier: Apache-2.0
#include "apps/bench/all_benches.hpp"

#include <gmock/gmock.h>

namespace palpate {
namespace all_benches_test {

using testing::HasSubstr;
using testing::Not;

std::vector<BenchOutcome> someOutcomes() {
  BenchResult servo;
  servo.machine = "a machine";
  servo.commit = "0123";
  servo.targets = {{"cost [ns]", 31.5, 35}, {"error [voxel]", 0.02, 0.015}};
  return {{"servo", "What a tick costs", 12.4, servo, "", "servo.md"},
          {"loop", "How well the loop keeps its times", 1, std::nullopt, "it was ended by signal 11", ""}};
}

TEST(AllBenches, EachIsTold) {
  EXPECT_EQ(outcomeInWords(someOutcomes()[0]), "servo: 1 of 2 targets hold, 12 s");
  EXPECT_EQ(outcomeInWords(someOutcomes()[1]), "loop: failed: it was ended by signal 11");
}

TEST(AllBenches, ThePageLinksAndSaysWhichFailed) {
  const std::string page = allBenchesPage(someOutcomes(), "palpate bench all --quick");
  for (const char* words :
       {"- machine: a machine\n- commit: 0123\n", "- command: `palpate bench all --quick`\n",
        "| [servo](servo.md) | What a tick costs | 1 of 2 | 12 |\n",
        "| loop | How well the loop keeps its times | **failed**: it was ended by signal 11 | 1 |\n",
        "| servo | cost [ns] | 31.5 | 35 | holds |\n"}) {
    EXPECT_THAT(page, HasSubstr(words));
  }
  const std::string broken = page.substr(0, page.find("## All targets"));
  EXPECT_THAT(broken, HasSubstr("| servo | error [voxel] | 0.02 | 0.015 | **does not hold** |\n"));
  EXPECT_THAT(broken, Not(HasSubstr("cost [ns]")));
}

TEST(AllBenches, WhereAllHoldsThePageSaysSo) {
  std::vector<BenchOutcome> outcomes = someOutcomes();
  outcomes[0].result->targets.pop_back();
  EXPECT_THAT(allBenchesPage(outcomes, "palpate bench all"), HasSubstr("do not hold\n\nNone.\n"));
  EXPECT_THAT(allBenchesPage({}, "palpate bench all"), HasSubstr("None.\n"));
}

}  // namespace all_benches_test
}  // namespace palpate
