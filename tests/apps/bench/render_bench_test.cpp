// SPDX-License-Identifier: Apache-2.0
// A run on small phantoms: what it is made of. No time is asserted.
#include "apps/bench/render_bench.hpp"

#include <gmock/gmock.h>

namespace palpate {
namespace render_bench_test {

TEST(RenderBench, HasARowForEveryVolumeViewAndKernel) {
  Progress progress;
  RenderBenchRequest request;
  request.sizes = {48};
  request.phantoms = {"sphere", "box"};
  request.width = 64;
  request.height = 48;
  request.repetitions = 3;
  request.views = 2;
  request.seed = 5;
  request.scan = false;
  const BenchResult result = runRenderBench(request, progress);
  EXPECT_EQ(result.bench, "render");
  const BenchRows ours = rowsOf(result, "picture", {{"kernel", "cell tree"}});
  const BenchRows before = rowsOf(result, "picture", {{"kernel", "half-voxel steps"}});
  ASSERT_EQ(ours.size(), 4U);
  ASSERT_EQ(before.size(), 4U);
  EXPECT_EQ(result.rows.size(), 8U);
  double largest = 0;
  for (std::size_t n = 0; n < 4; ++n) {
    const BenchRow &row = *ours[n], &other = *before[n];
    EXPECT_EQ(textOf(row, "volume"), n < 2 ? "sphere 48^3" : "box 48^3");
    EXPECT_EQ(textOf(other, "volume"), textOf(row, "volume"));
    EXPECT_EQ(figureOf(row, "view"), n % 2);
    EXPECT_EQ(figureOf(row, "pixels"), 64 * 48);
    EXPECT_EQ(figureOf(row, "repetitions"), 3);
    EXPECT_EQ(figureOf(row, "seed"), 5);
    EXPECT_GT(figureOf(row, "hit_share"), 0.05);
    EXPECT_LT(figureOf(row, "hit_share"), 0.9);
    EXPECT_GE(figureOf(row, "time_max_us_a_pixel"), figureOf(row, "time_median_us_a_pixel"));
    EXPECT_EQ(figureOf(row, "time_over_before"),
              figureOf(row, "time_median_us_a_pixel") / figureOf(other, "time_median_us_a_pixel"));
    EXPECT_EQ(figureOf(other, "time_over_before"), 1);
    largest = std::max(largest, figureOf(row, "time_over_before"));
    for (const BenchRow* either : {&row, &other}) {
      EXPECT_GT(figureOf(*either, "error_median_voxel"), 0);
      EXPECT_LE(figureOf(*either, "error_median_voxel"), figureOf(*either, "error_p99_voxel"));
      EXPECT_LE(figureOf(*either, "error_p99_voxel"), figureOf(*either, "error_max_voxel"));
    }
    EXPECT_EQ(figureOf(row, "holes"), 0);
    EXPECT_EQ(figureOf(row, "false_hits"), 0);
  }
  ASSERT_EQ(result.targets.size(), 5U);  // the time, and an error and the holes of either volume
  EXPECT_EQ(result.targets[0].value, largest);
  EXPECT_EQ(result.targets[0].bound, 0.4);
  EXPECT_EQ(result.targets[1].bound, 0.01);
  EXPECT_EQ(result.targets[2].value, 0);
  EXPECT_THAT(renderTable(result), testing::HasSubstr("half-voxel steps"));
  EXPECT_THAT(renderChart(result), testing::HasSubstr("cell tree"));
}

}  // namespace render_bench_test
}  // namespace palpate
