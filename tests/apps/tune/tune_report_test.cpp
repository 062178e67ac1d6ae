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

}  // namespace tune_report_test
}  // namespace palpate
