// SPDX-License-Identifier: Apache-2.0
// apps/bench/edit_bench.hpp: `palpate bench edit`: what an edit costs, from the command to the published window and
// back into the volume, and what it would cost to compute everything anew.
//
// Every volume holds the same surface: a plane through its middle, object below, which a brush dents or raises at
// random places around the centre; a window lies there. After each edit whole bricks put the surface back, unmeasured,
// so that every edit meets the same one. Volumes take turns edit by edit, so what else the machine does meets all
// alike. Half of the edits are timed by the device, kernel by kernel; sums come from the other half.
//
// A volume's whole is computed anew now and then between edits. Rows by "part": edit (a volume and a radius each),
// ratio, note. One thread. Throws Error as Engine does, and Error(kCancelled) on Ctrl-C. Memory: 2048^3 takes some 5
// GiB.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "apps/bench/bench_result.hpp"
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
// Time against radius by stage, a panel a volume.
[[nodiscard]] std::string editChart(const BenchResult& result);

}  // namespace palpate
