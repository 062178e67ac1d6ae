// SPDX-License-Identifier: Apache-2.0
// apps/bench/render_bench.hpp: `palpate bench render`: what a picture of the isosurface costs and how true its depth
// is, beside the kernel that stepped by half voxels (half_voxel_march.hpp), OpenVDB's ray tracer and VTK's ray caster.
//
// Phantoms and a CT head, from several sides, all in turns. On phantoms each depth is compared with the exact distance
// along its ray. Rows by "part": "picture", one for each volume, view and kernel; "note". One thread. Throws Error as
// Drawing does, and Error(kCancelled) on Ctrl-C.
#pragma once

#include <string>
#include <vector>

#include "apps/bench/bench_result.hpp"
#include "apps/bench/log_chart.hpp"
#include "apps/console/progress.hpp"

namespace palpate {

struct RenderBenchRequest {
  std::vector<int> sizes = {};  // of phantoms, along every edge [voxel]
  std::vector<std::string> phantoms = {"sphere", "knot", "head"};
  int width = 640, height = 480;  // [pixel]
  int repetitions = 7;
  std::uint64_t seed = 1;  // of the views
  int views = 3;
  std::string gpu = {};
  bool scan = true;                                        // the CT head too, where it is known
  std::vector<std::string> python = {"/usr/bin/python3"};  // interpreter with VTK, and its options

  [[nodiscard]] static RenderBenchRequest quick() {
    return {.width = 320, .height = 240, .repetitions = 3, .views = 2};
  }
};

[[nodiscard]] BenchResult runRenderBench(const RenderBenchRequest& request, Progress& progress);
[[nodiscard]] std::string renderTable(const BenchResult& result);
[[nodiscard]] LogCharts renderCharts(const BenchResult& result);  // depth error against time a pixel

}  // namespace palpate
