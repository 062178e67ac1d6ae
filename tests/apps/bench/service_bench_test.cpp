// SPDX-License-Identifier: Apache-2.0
// Rows, targets, table and chart of pairs that were made up. What the verb itself gives:
// tests/apps/palpate/bench_test.cpp.
#include "apps/bench/service_bench.hpp"

#include <gmock/gmock.h>

#include "apps/bench/result_file.hpp"

namespace palpate {
namespace service_bench_test {

using testing::HasSubstr;

// Of each figure another multiple of `value`.
ServiceFigures figuresOf(double value) {
  ServiceFigures figures;
  figures.ticks = 100;
  figures.edits = 4;
  for (Percentiles* of : {&figures.window_age_ms, &figures.first_use_us, &figures.to_window_ms, &figures.tick_cost_us,
                          &figures.lateness_us}) {
    *of = {.count = 100, .p50 = value, .p90 = 2 * value, .p99 = 3 * value, .p999 = 4 * value, .max = 5 * value};
    value *= 10;
  }
  return figures;
}

BenchResult madeUpResult() {
  BenchResult result;
  result.bench = "service";
  addServicePairs(result,
                  {{figuresOf(10), figuresOf(11)}, {figuresOf(20), figuresOf(22)}, {figuresOf(10), figuresOf(13)}});
  return result;
}

TEST(ServiceBench, HasARowForEveryRunAndFigure) {
  const BenchResult result = madeUpResult();
  ASSERT_EQ(rowsOf(result, "run").size(), 6U);
  const BenchRows twos = rowsOf(result, "run", {{"processes", "two"}});
  ASSERT_EQ(twos.size(), 3U);
  EXPECT_EQ(figureOf(*twos[2], "pair"), 2);
  EXPECT_EQ(figureOf(*twos[2], "window_age_p99_ms"), 39);
  EXPECT_EQ(figureOf(*twos[2], "edit_to_window_median_ms"), 1300);
  EXPECT_EQ(figureOf(*twos[2], "tick_cost_p99_us"), 39000);
  EXPECT_EQ(figureOf(*twos[2], "first_use_median_us"), 130);
  EXPECT_EQ(figureOf(*twos[2], "lateness_p999_us"), 520000);
}

TEST(ServiceBench, ARatioIsOfTheFigureThatItNames) {
  const BenchResult result = madeUpResult();
  const std::vector<std::pair<const char*, double>> medians = {{"window age p99 [ms]", 30},
                                                               {"tick cost median [us]", 10e3},
                                                               {"tick cost p99 [us]", 30e3},
                                                               {"edit to window median [ms]", 1e3},
                                                               {"edit to window p99 [ms]", 3e3},
                                                               {"window age median [ms]", 10},
                                                               {"window age at first use median [us]", 100},
                                                               {"window age at first use p99 [us]", 300},
                                                               {"lateness median [us]", 100e3},
                                                               {"lateness p99 [us]", 300e3}};
  EXPECT_EQ(rowsOf(result, "ratio").size(), medians.size());
  for (const auto& [figure, median] : medians) {
    const BenchRows rows = rowsOf(result, "ratio", {{"figure", figure}});
    ASSERT_EQ(rows.size(), 1U) << figure;
    EXPECT_EQ(figureOf(*rows[0], "one_median"), median) << figure;
    EXPECT_NEAR(figureOf(*rows[0], "ratio_median"), 1.1, 1e-12) << figure;
    EXPECT_NEAR(figureOf(*rows[0], "ratio_most"), 1.3, 1e-12) << figure;
    EXPECT_EQ(figureOf(*rows[0], "again_quartile_3"), 2) << figure;  // 20 / 10
  }
}

TEST(ServiceBench, PromisesTheMedianOfTheRatios) {
  const BenchResult result = madeUpResult();
  ASSERT_EQ(result.targets.size(), 4U);
  for (const BenchTarget& target : result.targets) EXPECT_NEAR(target.value, 1.1, 1e-12) << target.name;
  EXPECT_EQ(result.targets[0].name, "window age p99, two processes / one [-]");
  EXPECT_TRUE(result.targets[0].holds());
  EXPECT_EQ(result.targets[1].name, "tick cost median, two processes / one [-]");
  EXPECT_FALSE(result.targets[1].holds());
  EXPECT_FALSE(result.targets[2].holds());
  EXPECT_TRUE(result.targets[3].holds());
}

TEST(ServiceBench, IsShown) {
  const BenchResult result = madeUpResult();
  const std::string table = serviceTable(result);
  EXPECT_THAT(table, testing::ContainsRegex("window age p99 \\[ms\\] +30.00 +39.00 1.100 "));
  EXPECT_THAT(
      table,
      HasSubstr("\none: 3 runs, 300 ticks, 0 left out, 0 with a stale window, 0 windows, 12 edits, 0 not seen\n"));
  EXPECT_THAT(table, HasSubstr("\ntwo: 3 runs, "));
  const std::string chart = logChartSvg(serviceCharts(result));
  EXPECT_THAT(chart, HasSubstr("edit to window median [ms]"));
  EXPECT_THAT(chart, HasSubstr("pairs"));
}

}  // namespace service_bench_test
}  // namespace palpate
