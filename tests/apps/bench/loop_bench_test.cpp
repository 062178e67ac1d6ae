// SPDX-License-Identifier: Apache-2.0
// A run of a second with a real engine: what it is made of. No time is asserted, and cyclictest may be absent.
#include "apps/bench/loop_bench.hpp"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>
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
  EXPECT_THAT(logChartSvg(loopCharts(result)), HasSubstr("4000 Hz"));
}

// Classes of a side's histogram, in ascending order.
struct Classes {
  BenchRows rows;
  [[nodiscard]] double from(double lateness_us) const {  // wake-ups in classes that begin there or later
    double sum = 0;
    for (const BenchRow* row : rows) {
      if (figureOf(*row, "lateness_from_us") >= lateness_us) sum += figureOf(*row, "wakeups");
    }
    return sum;
  }
};

// Two accounts of the same wake-ups: the histogram's classes, and the row of figures. One turn is all there is.
void expectOneAccount(const BenchRow& row, const Classes& classes) {
  const double wakeups = figureOf(row, "wakeups");
  EXPECT_EQ(classes.from(0), wakeups);  // every wake-up is in a class
  EXPECT_EQ(classes.from(1000), figureOf(row, "deadline_misses"));
  for (std::size_t n = 0; n < classes.rows.size(); ++n) {
    const BenchRow& one = *classes.rows[n];
    const double later = n + 1 < classes.rows.size() ? classes.from(figureOf(one, "lateness_from_us") + 1) : 0;
    EXPECT_EQ(figureOf(one, "share_later"), later / wakeups);
  }
  // A quantile lies in the class in which so many wake-ups are reached.
  for (const auto& [word, q] : {std::pair("median", 0.5), {"p90", 0.9}, {"p99", 0.99}, {"p999", 0.999}, {"max", 1.0}}) {
    const double value_us = figureOf(row, fmt::format("lateness_{}_us", word));
    double begin_us = 0, next_us = 1e9;
    for (const BenchRow* one : classes.rows) {
      const double from_us = figureOf(*one, "lateness_from_us");
      if (from_us <= value_us) begin_us = from_us;
      if (from_us > value_us) next_us = std::min(next_us, from_us);
    }
    const double rank = std::ceil(q * wakeups * (1 - 1e-12));
    EXPECT_LT(wakeups - classes.from(begin_us), rank) << word;
    EXPECT_GE(wakeups - classes.from(next_us), rank) << word;
  }
  for (const char* quartile : {"quartile_1", "median", "quartile_3"}) {
    EXPECT_EQ(figureOf(row, fmt::format("turn_p99_{}_us", quartile)), figureOf(row, "lateness_p99_us")) << quartile;
  }
}

TEST(LoopBench, FiguresAndHistogramAgree) {
  Progress progress;
  LoopBenchRequest request = shortRun();
  request.rates_hz = {1000};
  request.seconds = request.turn_s;
  request.seed = 3;
  const BenchResult result = runLoopBench(request, progress);
  const BenchRow& loop = *rowsOf(result, "loop").at(0);
  expectOneAccount(loop, {rowsOf(result, "histogram", {{"side", "loop"}})});
  EXPECT_EQ(figureOf(loop, "seed"), 3);
  // Cut down to whole microseconds, as cyclictest does, and in classes up to a tenth of a second.
  EXPECT_EQ(std::clamp(std::floor(figureOf(loop, "lateness_exact_p99_us")), 0.0, 1e5),
            figureOf(loop, "lateness_p99_us"));
  for (const auto& [name, unit] : {std::pair("tick_cost", "us"), {"window_age", "ms"}, {"plane_age", "ticks"}}) {
    const auto figure = [&, name = name, unit = unit](const char* word) {
      return figureOf(loop, fmt::format("{}_{}_{}", name, word, unit));
    };
    EXPECT_LE(figure("median"), figure("p99")) << name;
    EXPECT_LE(figure("p99"), figure("p999")) << name;
    EXPECT_LE(figure("p999"), figure("max")) << name;
  }
  if (rowsOf(result, "cyclictest").empty()) return;
  const BenchRow& cyclic = *rowsOf(result, "cyclictest").at(0);
  expectOneAccount(cyclic, {rowsOf(result, "histogram", {{"side", "cyclictest"}})});
  const double ratio = figureOf(loop, "lateness_p99_us") / std::max(1.0, figureOf(cyclic, "lateness_p99_us"));
  EXPECT_EQ(figureOf(*rowsOf(result, "ratio").at(0), "loop_over_cyclictest_p99"), ratio);
  EXPECT_EQ(result.targets[0].value, ratio);
  EXPECT_EQ(result.targets[1].value, figureOf(loop, "deadline_misses"));
  EXPECT_EQ(result.targets[1].bound, figureOf(cyclic, "deadline_misses"));
}

TEST(LoopBench, TheTableEndsWithALineForEachRate) {
  BenchResult result;
  result.rows = {{{"part", "loop"},
                  {"rate_hz", 1000.0},
                  {"windows_published", std::int64_t{7}},
                  {"window_age_median_ms", 1.5},
                  {"window_age_p99_ms", 9.5},
                  {"plane_age_max_ticks", 4.0},
                  {"overrun_ticks", std::int64_t{3}},
                  {"skipped_ticks", std::int64_t{2}}},
                 {{"part", "ratio"}, {"rate_hz", 1000.0}, {"loop_over_cyclictest_p99", 1.25}}};
  EXPECT_THAT(loopTable(result),
              testing::EndsWith("1000 Hz: windows 7, window age p50 1.5 ms p99 9.5 ms, plane age max "
                                "4 ticks, overrun in 3 ticks, 2 left out\n"
                                "1000 Hz: lateness p99, loop / cyclictest 1.25\n"));
}

TEST(LoopBench, RefusesADeviceThatIsNotThere) {
  Progress progress;
  LoopBenchRequest request = shortRun();
  request.gpu = "Voodoo";
  EXPECT_THROW(static_cast<void>(runLoopBench(request, progress)), Error);
}

}  // namespace loop_bench_test
}  // namespace palpate
