// SPDX-License-Identifier: Apache-2.0
// A run on small files: what it is made of. No time is asserted.
#include "apps/bench/load_bench.hpp"

#include <gmock/gmock.h>

namespace palpate {
namespace load_bench_test {

TEST(LoadBench, HasARowAndATargetForEveryFormat) {
  Progress progress;
  LoadBenchRequest request;
  request.sizes = {24};
  request.repetitions = 3;
  request.suffixes = {".nrrd", ".nii.gz", ".mha", ".vdb"};
  const BenchResult result = runLoadBench(request, progress);
  EXPECT_EQ(result.bench, "load");
  ASSERT_EQ(result.rows.size(), 4U);
  ASSERT_EQ(result.targets.size(), 4U);
  for (std::size_t n = 0; n < 4; ++n) {
    const BenchRow& row = result.rows[n];
    EXPECT_EQ(textOf(row, "format"), request.suffixes[n]);
    EXPECT_GT(figureOf(row, "library_median_s"), 0);
    EXPECT_EQ(result.targets[n].value, figureOf(row, "load_median_s") / figureOf(row, "library_median_s"));
    EXPECT_EQ(result.targets[n].bound, 1.5);
  }
  EXPECT_GT(figureOf(result.rows[0], "file_bytes"), 4 * 24 * 24 * 24);  // raw floats and a header
  EXPECT_THAT(loadTable(result), testing::HasSubstr(".nii.gz"));
}

// One repetition: its time is the median, the largest and the first, and the first reading of the file does not count.
TEST(LoadBench, OneRepetitionIsEveryFigure) {
  Progress progress;
  LoadBenchRequest request;
  request.sizes = {16, 24};
  request.repetitions = 1;
  request.suffixes = {".nii"};
  request.seed = 7;
  const BenchResult result = runLoadBench(request, progress);
  ASSERT_EQ(result.rows.size(), 2U);
  for (std::size_t n = 0; n < 2; ++n) {
    const BenchRow& row = result.rows[n];
    const int size = request.sizes[n];
    EXPECT_EQ(figureOf(row, "volume_voxel"), size);
    EXPECT_EQ(figureOf(row, "file_bytes"), 352 + 4 * size * size * size);  // a header, then floats
    EXPECT_EQ(figureOf(row, "repetitions"), 1);
    EXPECT_EQ(figureOf(row, "seed"), 7);
    EXPECT_EQ(figureOf(row, "library_max_s"), figureOf(row, "library_median_s"));
    EXPECT_EQ(figureOf(row, "load_max_s"), figureOf(row, "load_median_s"));
    EXPECT_EQ(figureOf(row, "load_first_s"), figureOf(row, "load_median_s"));
    EXPECT_EQ(figureOf(row, "load_over_library"), figureOf(row, "load_median_s") / figureOf(row, "library_median_s"));
  }
}

}  // namespace load_bench_test
}  // namespace palpate
