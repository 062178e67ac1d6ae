// SPDX-License-Identifier: Apache-2.0
// Short sessions on a small phantom: what the result is made of. No time is asserted.
#include "apps/bench/live_bench.hpp"

#include <cmath>

#include <gmock/gmock.h>

namespace palpate {
namespace live_bench_test {

TEST(LiveBench, HasARowForEverySession) {
  Progress progress(nullptr);
  LiveBenchRequest request = LiveBenchRequest::quick();
  request.seconds = 0.7;
  request.volume = "phantom:sphere?size=48";
  request.width = 96;
  request.height = 64;
  const BenchResult result = runLiveBench(request, progress);
  EXPECT_EQ(result.bench, "live");
  EXPECT_NE(result.vulkan_device, "none");
  ASSERT_EQ(result.rows.size(), 3U);
  for (const char* drawn : {"nothing", "camera stands", "camera turns"}) {
    const BenchRows rows = rowsOf(result, "live", {{"drawn", drawn}});
    ASSERT_EQ(rows.size(), 1U) << drawn;
    const BenchRow& row = *rows[0];
    EXPECT_GE(figureOf(row, "seconds"), 0.7);
    EXPECT_GT(figureOf(row, "edits"), 0) << drawn;
    EXPECT_GT(figureOf(row, "resident_MiB"), 10);
    EXPECT_GE(figureOf(row, "lateness_p999_us"), figureOf(row, "lateness_median_us"));
    EXPECT_GT(figureOf(row, "window_age_p99_ms"), 0);
    const bool draws = std::string(drawn) != "nothing";
    EXPECT_EQ(figureOf(row, "pictures") > 0, draws);
    EXPECT_EQ(std::isnan(figureOf(row, "between_pictures_ms")), !draws);
    EXPECT_EQ(std::isnan(figureOf(row, "ready_s")), !draws);
    EXPECT_EQ(std::isnan(figureOf(row, "settling_ms")), std::string(drawn) != "camera turns");
    EXPECT_EQ(figureOf(row, "edit_to_pixel_p99_ms") > 0, draws);
    if (draws) {
      EXPECT_NEAR(figureOf(row, "between_pictures_ms") * figureOf(row, "pictures"), 1e3 * figureOf(row, "seconds"), 1);
    }
    const BenchRow& undrawn = *rowsOf(result, "live", {{"drawn", "nothing"}})[0];
    EXPECT_EQ(figureOf(row, "lateness_over_undrawn"),
              figureOf(row, "lateness_p999_us") / figureOf(undrawn, "lateness_p999_us"));
    EXPECT_EQ(figureOf(row, "window_age_over_undrawn"),
              figureOf(row, "window_age_p99_ms") / figureOf(undrawn, "window_age_p99_ms"));
  }
  ASSERT_EQ(result.targets.size(), 11U);
  EXPECT_EQ(result.targets[0].value,
            figureOf(*rowsOf(result, "live", {{"drawn", "camera stands"}})[0], "between_pictures_ms"));
  EXPECT_NEAR(result.targets[0].bound, 1000.0 / 30, 1e-9);
  EXPECT_THAT(liveTable(result), testing::HasSubstr("camera turns"));
  EXPECT_THAT(logChartSvg(liveCharts(result)), testing::HasSubstr("camera stands"));
}

}  // namespace live_bench_test
}  // namespace palpate
