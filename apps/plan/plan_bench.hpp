// SPDX-License-Identifier: Apache-2.0
// apps/plan/plan_bench.hpp: `palpate bench plan`: what each feature of a scene costs: from a bare touch, which leaves
// out all that it can, up to everything at once.
//
// Each run is this program as a process of its own; all scenes take turns. Rows by "part": "ladder", where each scene
// has a feature more than the one before; "alone", where each has one feature more than the bare touch; "note".
// Thread: the caller's, which waits.
#pragma once

#include <cstdint>
#include <string>

#include "apps/bench/bench_result.hpp"
#include "apps/bench/benches.hpp"
#include "apps/bench/log_chart.hpp"
#include "apps/console/progress.hpp"

namespace palpate {

struct PlanBenchRequest {
  int rounds = 5;
  bool warms_up = true;     // a first round that does not count
  std::string volume = {};  // empty: the CT head where it is known, or a phantom
  std::string gpu = {};
  std::string program = {};  // empty: this one

  [[nodiscard]] static PlanBenchRequest quick() { return {.rounds = 1, .warms_up = false}; }
};

// Throws Error: as countedRun() does.
[[nodiscard]] BenchResult runPlanBench(const PlanBenchRequest& request, Progress& progress);

[[nodiscard]] std::string planTable(const BenchResult& result);
[[nodiscard]] LogCharts planCharts(const BenchResult& result);  // memory against start

[[nodiscard]] Bench planBench();

}  // namespace palpate
