// SPDX-License-Identifier: Apache-2.0
// A run of a few edits on small volumes: what it is made of, and that every edit met the same surface. No time is
// asserted.
#include "apps/bench/edit_bench.hpp"

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
  EXPECT_THAT(editChart(result), HasSubstr("96^3"));
  EXPECT_THAT(editChart(result), HasSubstr("gradient kernel"));
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
