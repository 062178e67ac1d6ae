// SPDX-License-Identifier: Apache-2.0
// apps/bench/loop_bench.hpp: `palpate bench loop`: how well the real-time loop keeps its times, beside cyclictest.
//
// The real ServoLoop (hri, n = 5, simulated device with a rigid hand) palpates a knot at 0.5 m/s while the engine, on
// its own thread and its own Vulkan device, gathers a window every 12 ms. It takes turns of half a second with
// cyclictest at the same rate and priority: loop, cyclictest, cyclictest, loop, ... so that what else the machine does
// meets both alike; while cyclictest runs the engine follows the same path, fed by an ordinary thread, which runs in
// the loop's turns too. A miss is, for both, a wake-up later than a period. Lateness counts from the due time to the
// first reading of the clock.
//
// Rows by "part": loop and cyclictest (a rate each), ratio, histogram (classes of lateness), note. Threads: the loop's,
// the engine's, the feeder's; the caller waits. Where cyclictest is absent or SCHED_FIFO refused, it is said in a note.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "apps/bench/bench_result.hpp"
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
// Share of wake-ups that are later than a time, a panel a rate.
[[nodiscard]] std::string loopChart(const BenchResult& result);

}  // namespace palpate
