// SPDX-License-Identifier: Apache-2.0
// apps/bench/edit_bench.hpp: `palpate bench edit`: the cost of an edit, from the command to the published window and
// back into the volume, and the cost of computing everything anew instead.
//
// Every volume holds the same surface: a plane through its middle, with the object below. A brush dents or raises it at
// random places around the centre, where the window lies. After each edit the original bricks are put back, unmeasured,
// so every edit meets the same surface. Volumes take turns of eight edits, so that other load on the machine meets all
// alike. In half of the edits the device times its kernels; sums come from the other half.
//
// Rows by "part": edit (one for each volume and radius), ratio, note. One thread. Throws Error as Engine does, and
// Error(kCancelled) on Ctrl-C. Memory: some 5 GiB for 2048^3.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "apps/bench/bench_result.hpp"
#include "apps/bench/log_chart.hpp"
#include "apps/console/progress.hpp"

namespace palpate {

struct EditBenchRequest {
  std::vector<int> sizes = {};                    // along every edge, multiples of 16 [voxel]
  std::vector<double> radii = {2, 4, 8, 16, 32};  // [voxel]
  int all_size = 256;                             // of the volume whose bricks all have gradients [voxel]
  int repetitions = 120;                          // for each volume and radius
  std::uint64_t seed = 1;
  std::string gpu{};  // part of the Vulkan device's name

  [[nodiscard]] static EditBenchRequest quick() { return {.radii = {4, 8, 16}, .repetitions = 40}; }
};

[[nodiscard]] BenchResult runEditBench(const EditBenchRequest& request, Progress& progress);

[[nodiscard]] std::string editTable(const BenchResult& result);
// Time against radius by stage, a panel for each volume.
[[nodiscard]] LogCharts editCharts(const BenchResult& result);

}  // namespace palpate
