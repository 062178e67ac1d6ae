// SPDX-License-Identifier: Apache-2.0
// apps/bench/start_bench.hpp: `palpate bench start`: how long the program takes until it does what it was asked for.
//
// Each job is this program as a process of its own, with its output thrown away; the jobs take turns, begun by another
// one in each round. The wall clock of a job runs from before its process is made until after it has ended. A touch
// also tells the time from its start to its first tick (docs/summary.md), and how many shared libraries it had loaded.
// The driver's and the system's caches are warm: a first round is not counted. Rows of part "start", one for each job.
// Thread: the caller's, which waits.
#pragma once

#include <cstdint>
#include <string>

#include "apps/bench/bench_result.hpp"
#include "apps/bench/log_chart.hpp"
#include "apps/console/progress.hpp"

namespace palpate {

struct StartBenchRequest {
  int rounds = 40;
  std::uint64_t seed = 1;  // nothing is left to chance
  std::string program = "/proc/self/exe";

  [[nodiscard]] static StartBenchRequest quick() { return {.rounds = 20}; }
};

// Throws Error: kIo where a process or its folder cannot be made; kDevice where a job fails; kCancelled on Ctrl-C.
[[nodiscard]] BenchResult runStartBench(const StartBenchRequest& request, Progress& progress);

[[nodiscard]] std::string startTable(const BenchResult& result);
[[nodiscard]] LogCharts startCharts(const BenchResult& result);  // time over libraries

}  // namespace palpate
