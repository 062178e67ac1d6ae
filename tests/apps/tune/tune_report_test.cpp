// SPDX-License-Identifier: Apache-2.0
#include "apps/tune/tune_report.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

namespace palpate {
namespace tune_report_test {

using testing::HasSubstr;

TuneRequest request() {
  TuneRequest request;
  request.source = "a.toml";
  request.goal = {Goal::Kind::kBudget, 10};
  return request;
}

TuneResult result() {
  TuneResult result;
  result.found.trials = {{.error_N = 0.1, .loop_us = 6, .contact_share = 1}};
  result.found.base = result.chosen = result.found.trials.front();
  return result;
}

TEST(TuneReport, SaysHowManyWereFeltAnewInVain) {
  TuneResult in_vain = result();
  EXPECT_THAT(tuneWords(request(), in_vain), HasSubstr("Cannot    no candidate keeps --budget 10us"));
  in_vain.felt_anew = {in_vain.chosen, in_vain.chosen};
  EXPECT_THAT(tuneWords(request(), in_vain), HasSubstr("Cannot    none of the 2 felt anew keeps --budget 10us"));
  EXPECT_EQ(nlohmann::json::parse(tuneJson(request(), in_vain))["felt_anew"].size(), 2U);
}

TEST(TuneReport, QualifiesWhatWasMet) {
  TuneResult met = result();
  met.met = true;
  EXPECT_THAT(tuneWords(request(), met), HasSubstr("Met       in fresh runs"));
  met.felt_how = "without its brush";
  EXPECT_THAT(tuneWords(request(), met), HasSubstr("Met       without its brush, in fresh runs"));
}

// The figures of the fresh runs, not of the trial: that the same choice has two times says nothing to a user.
TEST(TuneReport, HasOneTimeForThePickedChoice) {
  TuneResult met = result();
  met.met = true;
  met.chosen.loop_us = 7.5;
  const std::string words = tuneWords(request(), met);
  EXPECT_THAT(words, HasSubstr("picked, felt anew"));
  EXPECT_THAT(words, HasSubstr(" 7.5 us a tick, "));
  EXPECT_THAT(words, testing::ContainsRegex(" 7\\.5 +0 +0  picked"));
  EXPECT_THAT(words, testing::Not(testing::ContainsRegex(" 6 +0 +0 ")));
}

TEST(TuneReport, SaysHowManyChoicesDoAsWell) {
  TuneResult met = result();
  met.met = true;
  met.found.as_good = 1;
  EXPECT_THAT(tuneWords(request(), met), testing::Not(HasSubstr("Equal")));
  met.found.as_good = 2;
  EXPECT_THAT(tuneWords(request(), met), HasSubstr("Equal     2 choices do as well but for chance"));
  EXPECT_EQ(nlohmann::json::parse(tuneJson(request(), met))["choices_as_good"], 2);
}

}  // namespace tune_report_test
}  // namespace palpate
