// SPDX-License-Identifier: Apache-2.0
// apps/bench/loop_bench.hpp: `palpate bench loop`: how late the real-time loop wakes up, beside cyclictest.
//
// The real ServoLoop (hri, n = 5, simulated device with a rigid hand) palpates a knot at 0.5 m/s. Meanwhile the engine,
// on its own thread and Vulkan device, gathers a window every 12 ms. The loop takes turns of half a second with
// cyclictest at the same rate and priority: loop, cyclictest, cyclictest, loop, ... So other load on the machine meets
// both alike. While cyclictest runs, an ordinary thread moves the engine's tool along the same path; it runs, unused,
// in the loop's turns too.
//
// Lateness is the time from the due time to the first reading of the clock. A miss is a wake-up that is late by a
// period or more.
//
// Rows by "part": loop and cyclictest (one for each rate), ratio, histogram (classes of lateness), note. A note says if
// cyclictest is missing or SCHED_FIFO was refused. Threads: the loop's, the engine's, the feeder's; the caller waits.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "apps/bench/bench_result.hpp"
#include "apps/bench/log_chart.hpp"
#include "apps/console/progress.hpp"

namespace palpate {

struct LoopBenchRequest {
  std::string volume = "phantom:knot?size=128x128x64";
  std::vector<double> rates_hz = {1000, 4000, 10000};
  double seconds = 30;  // of each side at each rate [s]
  double turn_s = 0.5;
  double speed_m_per_s = 0.5;
  int priority = 80;
  std::uint64_t seed = 1;
  std::string gpu{};  // part of the Vulkan device's name

  [[nodiscard]] static LoopBenchRequest quick() { return {.seconds = 2}; }
};

// Fills rows, targets and the Vulkan device. Throws Error as Engine does, and Error(kCancelled) on Ctrl-C.
[[nodiscard]] BenchResult runLoopBench(const LoopBenchRequest& request, Progress& progress);

[[nodiscard]] std::string loopTable(const BenchResult& result);
// The fraction of wake-ups that are later than a time, a panel for each rate.
[[nodiscard]] LogCharts loopCharts(const BenchResult& result);

}  // namespace palpate
