// SPDX-License-Identifier: Apache-2.0
// A run of a second with a real engine: what it is made of. No time is asserted, and cyclictest may be absent.
#include "apps/bench/loop_bench.hpp"

#include <gmock/gmock.h>

#include "base/error.hpp"

namespace palpate {
namespace loop_bench_test {

using testing::HasSubstr;

LoopBenchRequest shortRun() {
  LoopBenchRequest request;
  request.volume = "phantom:sphere?size=64";
  request.rates_hz = {1000, 4000};
  request.seconds = 0.2;
  request.turn_s = 0.1;
  return request;
}

TEST(LoopBench, RunsTheLoopWhileTheEnginePublishes) {
  Progress progress;
  const BenchResult result = runLoopBench(shortRun(), progress);
  EXPECT_EQ(result.bench, "loop");
  EXPECT_NE(result.vulkan_device, "none");
  const auto loops = rowsOf(result, "loop");
  ASSERT_EQ(loops.size(), 2U);
  EXPECT_EQ(figureOf(*loops[0], "rate_hz"), 1000);
  for (const BenchRow* loop : loops) {
    const BenchRow& row = *loop;
    // Every grid point is a wake-up or was left out.
    EXPECT_EQ(figureOf(row, "wakeups") + figureOf(row, "skipped_ticks"), 0.2 * figureOf(row, "rate_hz"));
    EXPECT_GE(figureOf(row, "windows_published"), 2);  // each turn goes 47 mm; a window holds for 6
    EXPECT_LE(figureOf(row, "lateness_median_us"), figureOf(row, "lateness_p99_us"));
    EXPECT_LE(figureOf(row, "lateness_p99_us"), figureOf(row, "lateness_max_us"));
    EXPECT_GT(figureOf(row, "tick_cost_max_us"), 0);
    EXPECT_GT(figureOf(row, "window_age_max_ms"), 0);
    EXPECT_LE(figureOf(row, "plane_age_max_ticks"), 4);  // n = 5
    EXPECT_GT(figureOf(row, "plane_age_max_ticks"), 0);  // there was contact
  }
  // With cyclictest: a row a rate, and targets at 1 kHz. Without: a note, and no target that nothing stands behind.
  if (rowsOf(result, "cyclictest").empty()) {
    EXPECT_THAT(textOf(*rowsOf(result, "note").back(), "note"), HasSubstr("no comparison"));
    EXPECT_TRUE(result.targets.empty());
  } else {
    EXPECT_EQ(rowsOf(result, "cyclictest").size(), 2U);
    ASSERT_EQ(result.targets.size(), 2U);
    EXPECT_EQ(result.targets[0].bound, 1.2);
  }
  const std::string table = loopTable(result);
  EXPECT_THAT(table, testing::ContainsRegex("loop +4000 "));
  EXPECT_THAT(table, HasSubstr("1000 Hz: windows "));
  EXPECT_THAT(loopChart(result), HasSubstr("4000 Hz"));
}

// Every wake-up is in a class of the histogram.
TEST(LoopBench, HistogramHoldsEveryWakeUp) {
  Progress progress;
  LoopBenchRequest request = shortRun();
  request.rates_hz = {1000};
  const BenchResult result = runLoopBench(request, progress);
  double sum = 0;
  for (const BenchRow* row : rowsOf(result, "histogram", {{"side", "loop"}})) {
    sum += figureOf(*row, "wakeups");
  }
  EXPECT_EQ(sum, figureOf(*rowsOf(result, "loop").front(), "wakeups"));
}

TEST(LoopBench, RefusesADeviceThatIsNotThere) {
  Progress progress;
  LoopBenchRequest request = shortRun();
  request.gpu = "Voodoo";
  EXPECT_THROW(static_cast<void>(runLoopBench(request, progress)), Error);
}

}  // namespace loop_bench_test
}  // namespace palpate
