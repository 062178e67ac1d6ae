// SPDX-License-Identifier: Apache-2.0
// A test for every extreme case, under its own name.
#include <cctype>
#include <set>

#include <gtest/gtest.h>

#include "apps/extreme/extreme_case.hpp"

namespace palpate {
namespace extreme_cases_test {

class Extreme : public testing::TestWithParam<std::size_t> {};

TEST_P(Extreme, IsAsExpected) {
  const ExtremeCase& one = extremeCases()[GetParam()];
  const ExtremeOutcome outcome = outcomeOf(one);
  EXPECT_TRUE(outcome.as_expected) << one.group << ": " << one.name << "\nexpected: " << one.expectation
                                   << "\nseen: " << outcome.seen;
  EXPECT_FALSE(outcome.seen.empty());
}

// The name of a case as one word.
std::string wordOf(const testing::TestParamInfo<std::size_t>& info) {
  const ExtremeCase& one = extremeCases()[info.param];
  std::string word = one.group + "_";
  for (const char letter : one.name) word += std::isalnum(static_cast<unsigned char>(letter)) != 0 ? letter : '_';
  return word + "_" + std::to_string(info.param);
}

INSTANTIATE_TEST_SUITE_P(Case, Extreme, testing::Range(std::size_t{0}, extremeCases().size()), wordOf);

TEST(ExtremeCases, AreManyAndHaveNamesOfTheirOwn) {
  std::set<std::string> names;
  for (const ExtremeCase& one : extremeCases()) {
    EXPECT_TRUE(names.insert(one.group + ": " + one.name).second) << one.name;
    EXPECT_FALSE(one.expectation.empty()) << one.name;
  }
  EXPECT_GE(names.size(), 80U);
}

}  // namespace extreme_cases_test
}  // namespace palpate
