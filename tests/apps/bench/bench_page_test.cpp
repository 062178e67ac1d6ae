// SPDX-License-Identifier: Apache-2.0
#include "apps/bench/bench_page.hpp"

#include <gmock/gmock.h>

namespace palpate {
namespace bench_page_test {

using testing::HasSubstr;

BenchResult sample() {
  BenchResult result;
  result.machine = "a machine, 2 cores";
  result.commit = "0123456789";
  result.command = "palpate bench servo --seed 1";
  result.note("something is missing");
  result.targets = {{"cost [ns]", 31.5, 35}, {"error [voxel]", 0.02, 0.015}};
  return result;
}

TEST(BenchPage, SaysWhereTheFiguresComeFromAndWhatHolds) {
  const std::string page = benchPage(sample(), {"Title", "As follows.", "a b\n", "servo.svg"});
  EXPECT_THAT(page, testing::StartsWith("# Title\n\nAs follows.\n"));
  for (const char* words :
       {"- machine: a machine, 2 cores\n", "- Vulkan device: none\n", "- commit: 0123456789\n",
        "- command: `palpate bench servo --seed 1`\n", "![Title](servo.svg)\n", "| cost [ns] | 31.5 | 35 | holds |\n",
        "| error [voxel] | 0.02 | 0.015 | **does not hold** |\n", "Note: something is missing\n", "```\na b\n```\n"}) {
    EXPECT_THAT(page, HasSubstr(words));
  }
}

TEST(BenchPage, HasNoPictureWithoutAChart) {
  EXPECT_THAT(benchPage(sample(), {"Title", "As follows.", "a b\n", ""}), testing::Not(HasSubstr("![")));
}

}  // namespace bench_page_test
}  // namespace palpate
