// SPDX-License-Identifier: Apache-2.0
// apps/bench/servo_bench.hpp: `palpate bench servo`: cost and error of every algorithm, in one process.
//
// Rows, by their key "part":
//   tick      volume, algorithm, n: cost of a tick (tick_cost.hpp) and its errors (touch_errors.hpp) along one path;
//             K 500 N/m, B 0, 1 voxel deep, 0.1 m/s, 1 kHz (contact_path.hpp)
//   harness   what the measuring itself costs, and a tick that only pushes against the plane it has
//   ratio     cost of an algorithm at n = 5 against hri's in the same repetitions
//   accuracy  errors along a long path on finer knots
//   strokes   misses of fast strokes (strokes.hpp)
//   effects   force jumps with recovery time on and off (recovery_rows.hpp)
//   press     errors by noise and depth; speed: by speed and n (press_rows.hpp)
//   table     cost by noise and depth (table_one.hpp)
//   note      what was left out
// Frame W. Thread: the caller's; nothing else runs. No Vulkan device is opened.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "apps/bench/bench_result.hpp"
#include "apps/console/progress.hpp"

namespace palpate {

struct ServoBenchRequest {
  std::vector<std::string> volumes = {"phantom:sphere?size=64", "phantom:knot?size=64", "phantom:head?size=128x128x64",
                                      "phantom:lung?size=128x128x64"};
  std::vector<int> renewals = {1, 5, 10, 50};  // n; 1 and 5 are needed for targets
  std::size_t cost_ticks = 5000;               // of the path whose ticks are timed
  int repetitions = 25;
  int tick_replays = 9;
  std::size_t error_ticks = 20000;  // of the path beside
  // Targets are held against the first; the second has the voxels of phantom:head, 1.6 mm, so its surface turns away
  // under an aging plane 1.6 times more slowly.
  std::vector<std::string> accuracy_volumes = {"phantom:knot?size=128x128x64",
                                               "phantom:knot?size=128x128x64&spacing=1.6mm"};
  std::size_t accuracy_ticks = 100000;
  int strokes = 200;               // for each wall, speed and kind
  std::size_t press_ticks = 5000;  // of the paths with noise, depth and speed
  int press_seeds = 5;
  std::uint64_t seed = 1;

  [[nodiscard]] static ServoBenchRequest quick();  // under a minute
};

// Fills rows and targets; who and where (commit, command) is the caller's. Stops with Error(kCancelled) on Ctrl-C.
[[nodiscard]] BenchResult runServoBench(const ServoBenchRequest& request, Progress& progress);

// For the page: what was measured and how.
[[nodiscard]] std::string servoIntroduction();

[[nodiscard]] std::string servoTable(const BenchResult& result);  // for the terminal

// Cost against error, a series an algorithm, a point an n.
[[nodiscard]] std::string servoChart(const BenchResult& result);

}  // namespace palpate
