// SPDX-License-Identifier: Apache-2.0
// apps/bench/load_bench.hpp: `palpate bench load`: loading a volume beside what its format's library (ITK,
// OpenVDB) alone takes to read the file.
//
// Files of random floats, so that no brick is constant, are written into a temporary folder (512 MiB at a time) and
// read in turns from the system's cache: library, load, load, library. The ratio is that of the medians. Rows by
// "part": load, a format each. One thread here; loading takes all processors. Throws Error as writing and loading do,
// and Error(kCancelled) on Ctrl-C.
#pragma once

#include <string>
#include <vector>

#include "apps/bench/bench_result.hpp"
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
[[nodiscard]] std::string loadChart(const BenchResult& result);  // load against library, a point a format

}  // namespace palpate
