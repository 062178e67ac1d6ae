// SPDX-License-Identifier: Apache-2.0
// A short run in one process: what was asked for is made and felt. No time is asserted. Two processes: the verb's test,
// whose program has `palpate-servo` beside it.
#include "apps/bench/service_run.hpp"

#include <gmock/gmock.h>

#include "base/error.hpp"

namespace palpate {
namespace service_run_test {

constexpr const char* kVolume = "phantom:sphere?size=64";

TEST(ServiceRuns, AsksForEditsBesideTheServo) {
  ServiceRuns runs(kVolume, 1, 1, "", "");
  const ServiceRun run = runs.run(Processes::kOne);
  EXPECT_NE(runs.vulkanDevice(), "none");
  EXPECT_EQ(run.loop.ticks_run + run.loop.ticks_skipped, 1000);
  ASSERT_GE(run.asked.size(), 10U);
  for (std::size_t n = 0; n < run.asked.size(); ++n) {
    EXPECT_EQ(run.asked[n].version, n + 2);  // the first edit set the clock
    EXPECT_GE(run.asked[n].at_ns, run.asked[n == 0 ? 0 : n - 1].at_ns);
  }
  EXPECT_GT(run.asked[0].at_ns, run.loop.first_due_ns);
  const ServiceFigures figures = serviceFigures(run.loop, runs.rate_hz(), run.asked);
  EXPECT_GT(figures.edits, 0);
  EXPECT_GT(figures.windows, 0);
  EXPECT_GT(figures.to_window_ms.p50, 0);  // a window is later than what it shows
  EXPECT_LE(run.loop.records.back().edit_version, run.asked.back().version);
  EXPECT_TRUE(run.loop.records.back().in_contact);
}

TEST(ServiceRuns, RefusesWhatIsNotThere) {
  EXPECT_THROW(ServiceRuns("phantom:cloud", 1, 1, "", ""), Error);
  ServiceRuns runs(kVolume, 0.3, 1, "Voodoo", "");
  EXPECT_THROW(static_cast<void>(runs.run(Processes::kOne)), Error);
}

}  // namespace service_run_test
}  // namespace palpate
