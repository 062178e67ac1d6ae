// SPDX-License-Identifier: Apache-2.0
// apps/bench/service_bench.hpp: `palpate bench service`: what it costs that engine and servo are two processes.
//
// The same run (service_run.hpp) in one process and in two, in turns: one, two, two, one, ... So other load on the
// machine meets both alike. A short first pair is not counted. Each ratio is formed within a pair; what is promised is
// the median of the pairs' ratios. Beside it stands what two runs in one process, one pair after the other, differ by.
//
// Rows by "part": run (one for each run), ratio (one for each figure, over all pairs), note. Threads: as in
// service_run.hpp; the caller waits. Cost: real time.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "apps/bench/bench_result.hpp"
#include "apps/bench/log_chart.hpp"
#include "apps/bench/service_figures.hpp"
#include "apps/console/progress.hpp"

namespace palpate {

struct ServiceBenchRequest {
  std::string volume = "phantom:knot?size=128x128x64";
  double seconds = 2;  // of each run [s]; short, so that other load meets both runs of a pair
  int pairs = 30;
  std::string commit = {};  // of this program, which must be the servo's
  std::uint64_t seed = 1;   // of way and edits, the same in all runs
  std::string gpu = {};     // part of the Vulkan device's name

  [[nodiscard]] static ServiceBenchRequest quick() { return {.seconds = 1.5, .pairs = 3}; }
};

// Fills rows, targets and the Vulkan device. Throws Error as ServiceRuns does, and Error(kCancelled) on Ctrl-C.
[[nodiscard]] BenchResult runServiceBench(const ServiceBenchRequest& request, Progress& progress);

// Adds the rows and targets of these pairs.
void addServicePairs(BenchResult& result, const std::vector<ServicePair>& pairs);

// The ratios, and for each number of processes a line that adds up its runs, which JSON and CSV hold one by one.
[[nodiscard]] std::string serviceTable(const BenchResult& result);
// Two processes against one, a point for each pair and a panel for each figure that is promised.
[[nodiscard]] LogCharts serviceCharts(const BenchResult& result);

}  // namespace palpate
