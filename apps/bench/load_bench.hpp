// SPDX-License-Identifier: Apache-2.0
// apps/bench/load_bench.hpp: `palpate bench load`: the time to load a volume, beside the time that the format's library
// alone (ITK, OpenVDB) takes to read the file.
//
// The files hold random floats, so that no brick is constant. They are written into a temporary folder, 512 MiB at a
// time, and read from the system's cache, in turns: library, load, load, library. Rows by "part": load, one for each
// format, with the ratio of the medians. One thread here; loading uses all processors. Throws Error as writing and
// loading do, and Error(kCancelled) on Ctrl-C.
#pragma once

#include <string>
#include <vector>

#include "apps/bench/bench_result.hpp"
#include "apps/bench/log_chart.hpp"
#include "apps/console/progress.hpp"

namespace palpate {

struct LoadBenchRequest {
  std::vector<int> sizes = {};  // along every edge [voxel]
  std::vector<std::string> suffixes = {".nrrd", ".mha", ".nii", ".nii.gz", ".vdb"};
  int repetitions = 9;
  std::uint64_t seed = 1;

  [[nodiscard]] static LoadBenchRequest quick() { return {.repetitions = 5}; }
};

[[nodiscard]] BenchResult runLoadBench(const LoadBenchRequest& request, Progress& progress);

[[nodiscard]] std::string loadTable(const BenchResult& result);
[[nodiscard]] LogCharts loadCharts(const BenchResult& result);  // load against library, a point for each format

}  // namespace palpate
