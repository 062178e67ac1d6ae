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

}  // namespace load_bench_test
}  // namespace palpate
