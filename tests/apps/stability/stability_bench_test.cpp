// SPDX-License-Identifier: Apache-2.0
// The study as a whole, at a size that runs in seconds: its promises hold, and the same seed gives the same rows.
#include "apps/stability/stability_bench.hpp"

#include <cmath>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "apps/extreme/extreme_case.hpp"
#include "apps/stability/stiff_trial.hpp"
#include "apps/stability/study_device.hpp"
#include "base/error.hpp"

namespace palpate {
namespace stability_bench_test {

using testing::HasSubstr;

StabilityRequest small(std::uint64_t seed) {
  StabilityRequest request = StabilityRequest::quick();
  request.limit_damping = {0, 0.5};
  request.width_damping = {0.5};
  request.stiff_trials = 60;
  request.seed = seed;
  return request;
}

BenchResult run(const StabilityRequest& request) {
  Progress silent(nullptr);
  return runStabilityBench(request, silent);
}

TEST(StabilityBench, EveryPromiseHoldsAndEveryPartHasRows) {
  const BenchResult result = run(small(3));
  for (const BenchTarget& target : result.targets) EXPECT_TRUE(target.holds()) << target.name << " " << target.value;
  EXPECT_EQ(result.targets.size(), 10U);
  EXPECT_EQ(rowsOf(result, "extreme").size(), extremeCases().size());
  EXPECT_EQ(rowsOf(result, "limit").size(), 2 * studyDevices().size());
  EXPECT_EQ(rowsOf(result, "stiff").size(), 60U);
  EXPECT_GT(rowsOf(result, "width").size(), 2 * 3 * studyDevices().size());
  for (const StudyDevice& device : studyDevices()) {
    EXPECT_THAT(stabilityTable(result), HasSubstr(device.name));
    EXPECT_THAT(logChartSvg(stabilityCharts(result)), HasSubstr(device.name));
  }
}

TEST(StabilityBench, TheSameSeedGivesTheSameRows) {
  StabilityRequest request = small(5);
  request.limit_damping = {0.1};
  request.width_damping = {};
  request.stiff_trials = 20;
  const BenchResult once = run(request);
  EXPECT_EQ(csvText(once), csvText(run(request)));
  request.seed = 6;
  EXPECT_NE(csvText(once), csvText(run(request)));
}

TEST(StabilityBench, ItCanBeStopped) {
  Progress stop([](const std::string&, double done) {
    if (done > 0) throw Error(Error::Code::kCancelled, "test", "stopped", "nothing");
  });
  EXPECT_THROW(static_cast<void>(runStabilityBench(small(1), stop)), Error);
}

// The trials cover what they promise, and both verdicts.
TEST(StiffTrial, DrawsFromTheWholeRange) {
  int grows = 0, settles = 0;
  double softest = 1e9, stiffest = 0, lightest = 1e9, heaviest = 0, shortest = 1e9, longest = 0;
  for (std::uint64_t i = 0; i < 1000; ++i) {
    const StiffTrial trial = stiffTrial(1, i);
    const Expected expected = expectedOf(trial);
    grows += expected == Expected::kGrows ? 1 : 0;
    settles += expected == Expected::kSettles ? 1 : 0;
    softest = std::min(softest, trial.wall.stiffness_N_per_m);
    stiffest = std::max(stiffest, trial.wall.stiffness_N_per_m);
    lightest = std::min(lightest, trial.loop.hand.device_mass_kg);
    heaviest = std::max(heaviest, trial.loop.hand.device_mass_kg);
    shortest = std::min(shortest, 1 / trial.loop.rate_hz);
    longest = std::max(longest, 1 / trial.loop.rate_hz);
  }
  EXPECT_GT(grows, 200);
  EXPECT_GT(settles, 200);
  EXPECT_LT(softest, 12);
  EXPECT_GT(stiffest, 0.9e6);
  EXPECT_LT(lightest, 0.011);
  EXPECT_GT(heaviest, 9);
  EXPECT_LT(shortest, 52e-6);
  EXPECT_GT(longest, 9.8e-3);
}

}  // namespace stability_bench_test
}  // namespace palpate
