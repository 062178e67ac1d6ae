// SPDX-License-Identifier: Apache-2.0
// A run of a few edits on small volumes: what it is made of, and that every edit met the same surface. No time is
// asserted.
#include "apps/bench/edit_bench.hpp"

#include <algorithm>
#include <cmath>

#include <gmock/gmock.h>

#include "apps/bench/flat_volume.hpp"
#include "base/error.hpp"

namespace palpate {
namespace edit_bench_test {

using testing::HasSubstr;

EditBenchRequest shortRun() {
  EditBenchRequest request;
  request.sizes = {64, 96};
  request.radii = {2, 8};
  request.all_size = 64;
  request.repetitions = 6;
  return request;
}

TEST(EditBench, HasEveryStageOfEveryVolumeAndRadius) {
  Progress progress;
  const BenchResult result = runEditBench(shortRun(), progress);
  EXPECT_EQ(result.bench, "edit");
  EXPECT_NE(result.vulkan_device, "none");
  const auto edits = rowsOf(result, "edit");
  ASSERT_EQ(edits.size(), 2U * 3U);  // two radii; two volumes and the one with all gradients
  for (const BenchRow* edit : edits) {
    const BenchRow& row = *edit;
    EXPECT_EQ(figureOf(row, "edits"), 6);
    EXPECT_EQ(figureOf(row, "windows_published"), 6);
    EXPECT_EQ(figureOf(row, "bricks_not_put_back"), 0);
    EXPECT_GT(figureOf(row, "changed_bricks_median"), 0);
    EXPECT_GT(figureOf(row, "gpu_memory_MiB"), 0);
    EXPECT_GT(figureOf(row, "share_outside_kernels"), 0);
    EXPECT_LT(figureOf(row, "share_outside_kernels"), 1);
    for (const char* stage : {"to_window", "plan", "record", "submit_and_wait", "edit_kernel", "gradient_kernel",
                              "journal", "journal_saved", "window_kernel", "publish", "settle", "read_back", "sum"}) {
      EXPECT_GT(figureOf(row, std::string(stage) + "_median_ms"), 0) << stage;
      EXPECT_GE(figureOf(row, std::string(stage) + "_p99_ms"), figureOf(row, std::string(stage) + "_median_ms"));
    }
    const bool all = textOf(row, "gradients") == "all";  // which needs no bounds
    EXPECT_EQ(figureOf(row, "bounds_kernel_median_ms") == 0, all);
    // Of the same edits, so that the sum of each is more than its part.
    EXPECT_GE(figureOf(row, "sum_median_ms"), figureOf(row, "to_window_median_ms"));
    EXPECT_GT(figureOf(row, "recomputes"), 0);
    EXPECT_NEAR(figureOf(row, "recompute_over_edit"),
                figureOf(row, "recompute_median_ms") / figureOf(row, "to_window_median_ms"), 1e-9);
  }
  // The same edits meet the same surface, so they change the same number of bricks in every volume.
  EXPECT_EQ(figureOf(*edits[0], "changed_bricks_median"), figureOf(*edits[1], "changed_bricks_median"));
  // Two volumes to the window, the recompute, the share; no ratio without 64^3 and 1024^3.
  ASSERT_EQ(result.targets.size(), 4U);
  EXPECT_EQ(result.targets[0].bound, 3);
  EXPECT_EQ(result.targets[2].bound, 0.02);
  EXPECT_EQ(result.targets[3].bound, 0.5);
  EXPECT_THAT(editTable(result), HasSubstr("64^3 all"));
  EXPECT_THAT(editTable(result), HasSubstr("anew"));
  EXPECT_THAT(logChartSvg(editCharts(result)), HasSubstr("96^3"));
  EXPECT_THAT(logChartSvg(editCharts(result)), HasSubstr("gradient kernel"));
}

// Two edits: the clock measures one, the device's own clock the other. So most figures are one measurement, and what is
// made of several can be worked out again.
TEST(EditBench, FiguresAreMadeOfTheirParts) {
  Progress progress;
  EditBenchRequest request = shortRun();
  request.sizes = {64};
  request.radii = {8};
  request.repetitions = 2;
  request.seed = 5;
  const BenchResult result = runEditBench(request, progress);
  const auto edits = rowsOf(result, "edit");
  ASSERT_EQ(edits.size(), 2U);
  for (const BenchRow* edit : edits) {
    const auto ms = [&](const std::string& stage) { return figureOf(*edit, stage + "_median_ms"); };
    for (const char* stage : {"to_window", "plan", "settle", "read_back", "edit_kernel", "submit_and_wait", "sum"}) {
      EXPECT_EQ(figureOf(*edit, std::string(stage) + "_p99_ms"), ms(stage)) << stage;
    }
    // The whole ends with settling. Both edits are journalled; the sum has the time of one of them. 1e-9 is far above
    // the rounding of a few ms.
    const double journal = ms("sum") - ms("to_window") - ms("settle") - ms("read_back");
    const double other = figureOf(*edit, "journal_p99_ms");
    EXPECT_LT(std::min(std::abs(journal - ms("journal")), std::abs(journal - other)), 1e-9);
    EXPECT_GT(ms("to_window"), ms("plan") + ms("record") + ms("publish"));
    EXPECT_LT(ms("journal"), ms("journal_saved"));
    // The share outside kernels tells the other edit's way to the window, which is longer than the device was busy.
    const double kernels = ms("edit_kernel") + ms("bounds_kernel") + ms("gradient_kernel") + ms("window_kernel");
    EXPECT_GT(kernels / (1 - figureOf(*edit, "share_outside_kernels")), kernels + ms("submit_and_wait"));
    EXPECT_EQ(figureOf(*edit, "recomputes"), 1);
    EXPECT_EQ(figureOf(*edit, "recompute_p99_ms"), ms("recompute"));
    EXPECT_EQ(figureOf(*edit, "volume_voxel"), 64);
    EXPECT_EQ(figureOf(*edit, "radius_voxel"), 8);
    EXPECT_EQ(figureOf(*edit, "seed"), 5);
    // Three windows of 512 KiB are part of it; 512 bricks of densities and samples are 5 MiB.
    EXPECT_GT(figureOf(*edit, "gpu_memory_MiB"), 1.5);
    EXPECT_LT(figureOf(*edit, "gpu_memory_MiB"), 50);
  }
  ASSERT_EQ(result.targets.size(), 3U);
  EXPECT_EQ(result.targets[0].value, figureOf(*edits[0], "to_window_median_ms"));
  EXPECT_DOUBLE_EQ(result.targets[1].value,
                   figureOf(*edits[1], "to_window_median_ms") / figureOf(*edits[1], "recompute_median_ms"));
  EXPECT_EQ(result.targets[2].value,
            std::max(figureOf(*edits[0], "share_outside_kernels"), figureOf(*edits[1], "share_outside_kernels")));
}

TEST(EditBench, WithoutRadius8ItPromisesNothing) {
  Progress progress;
  EditBenchRequest request = shortRun();
  request.sizes = {64};
  request.radii = {4};
  const BenchResult result = runEditBench(request, progress);
  EXPECT_TRUE(result.targets.empty());
  EXPECT_THAT(textOf(*rowsOf(result, "note").back(), "note"), HasSubstr("radius 8"));
}

// The plane lies at k = 35.5, in the bricks with k from 32 to 39; all others are constant.
TEST(EditBench, TheFlatVolumeIsOneLayerOfBricks) {
  const Volume volume = flat_volume::make(64);
  EXPECT_EQ(volume.storedBricks(), 64U);
  EXPECT_EQ(volume.value({5, 9, 33}), 1.0F);
  EXPECT_EQ(volume.value({5, 9, 35}), 0.625F);
  EXPECT_EQ(volume.value({5, 9, 36}), 0.375F);
  EXPECT_EQ(volume.value({5, 9, 38}), 0.0F);
}

TEST(EditBench, RefusesADeviceThatIsNotThere) {
  Progress progress;
  EditBenchRequest request = shortRun();
  request.gpu = "Voodoo";
  EXPECT_THROW(static_cast<void>(runEditBench(request, progress)), Error);
}

}  // namespace edit_bench_test
}  // namespace palpate
