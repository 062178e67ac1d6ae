// SPDX-License-Identifier: Apache-2.0
// A run on small phantoms: what it is made of. No time is asserted.
#include "apps/bench/render_bench.hpp"

#include <cmath>

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
  request.python = {"/bin/false"};
  const BenchResult result = runRenderBench(request, progress);
  EXPECT_EQ(result.bench, "render");
  const BenchRows ours = rowsOf(result, "picture", {{"kernel", "cell tree"}});
  const BenchRows before = rowsOf(result, "picture", {{"kernel", "half-voxel steps"}});
  ASSERT_EQ(ours.size(), 4U);
  ASSERT_EQ(before.size(), 4U);
  const std::string rival = "OpenVDB LevelSetRayTracer, of a level set made before";
  const BenchRows rivals = rowsOf(result, "picture", {{"kernel", rival}});
  ASSERT_EQ(rivals.size(), 4U);
  EXPECT_EQ(result.rows.size(), 13U);  // and a note on VTK
  double largest = 0, largest_of_rival = 0;
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
    EXPECT_EQ(figureOf(row, "palpate_over_this"), 1);
    for (const BenchRow* one : {&other, rivals[n]}) {
      EXPECT_EQ(figureOf(*one, "palpate_over_this"),
                figureOf(row, "time_median_us_a_pixel") / figureOf(*one, "time_median_us_a_pixel"));
      EXPECT_NEAR(figureOf(*one, "hit_share"), figureOf(row, "hit_share"), 0.03);
    }
    EXPECT_TRUE(std::isnan(figureOf(*rivals[n], "error_median_voxel")));
    largest = std::max(largest, figureOf(other, "palpate_over_this"));
    largest_of_rival = std::max(largest_of_rival, figureOf(*rivals[n], "palpate_over_this"));
    for (const BenchRow* either : {&row, &other}) {
      EXPECT_GT(figureOf(*either, "error_median_voxel"), 0);
      EXPECT_LE(figureOf(*either, "error_median_voxel"), figureOf(*either, "error_p99_voxel"));
      EXPECT_LE(figureOf(*either, "error_p99_voxel"), figureOf(*either, "error_max_voxel"));
    }
    EXPECT_EQ(figureOf(row, "holes"), 0);
    EXPECT_EQ(figureOf(row, "false_hits"), 0);
  }
  ASSERT_EQ(result.targets.size(), 6U);  // the time against both, and an error and the holes of either volume
  EXPECT_EQ(result.targets[0].value, largest);
  EXPECT_EQ(result.targets[0].bound, 0.4);
  EXPECT_EQ(result.targets[1].value, largest_of_rival);
  EXPECT_EQ(result.targets[1].bound, 0.4);
  EXPECT_DOUBLE_EQ(result.targets[2].bound, 0.01 * 256 / 48);
  EXPECT_EQ(result.targets[3].value, 0);
  EXPECT_THAT(renderTable(result), testing::HasSubstr("half-voxel steps"));
  EXPECT_THAT(logChartSvg(renderCharts(result)), testing::HasSubstr("cell tree"));
}

}  // namespace render_bench_test
}  // namespace palpate
