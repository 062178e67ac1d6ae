// SPDX-License-Identifier: Apache-2.0
// apps/bench/live_bench.hpp: `palpate bench live`: how smooth the picture of a sculpting session is, and whether the
// servo notices that it is drawn.
//
// Sessions as the window has them, without a window: a tool drills along a circle on the surface while nothing is
// drawn, while the camera stands, and while it turns; in turns, each in a session of its own, so that all drill the
// same. Rows by "part": "live", one for each session; "note". Real time: a few seconds each. Throws Error as
// SculptSession does, and Error(kCancelled) on Ctrl-C.
#pragma once

#include <string>

#include "apps/bench/bench_result.hpp"
#include "apps/bench/log_chart.hpp"
#include "apps/console/progress.hpp"

namespace palpate {

struct LiveBenchRequest {
  double seconds = 5;              // of drilling in a session [s]
  int repetitions = 3;             // of each kind of session
  int width = 1280, height = 720;  // [pixel]
  std::uint64_t seed = 1;          // nothing is left to chance
  std::string gpu = {};
  std::string volume = {};  // empty: the CT head where it is known, or a phantom

  [[nodiscard]] static LiveBenchRequest quick() {
    return {.seconds = 1.5, .repetitions = 1, .width = 320, .height = 180, .volume = "phantom:head?size=64"};
  }
};

[[nodiscard]] BenchResult runLiveBench(const LiveBenchRequest& request, Progress& progress);
[[nodiscard]] std::string liveTable(const BenchResult& result);
[[nodiscard]] LogCharts liveCharts(const BenchResult& result);  // lateness against time between pictures

}  // namespace palpate
