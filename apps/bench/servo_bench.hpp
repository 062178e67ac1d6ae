// SPDX-License-Identifier: Apache-2.0
// apps/bench/servo_bench.hpp: `palpate bench servo`: cost and error of every algorithm, in one process.
//
// Rows, by their key "part":
//   tick      cost of a tick (tick_cost.hpp) and errors (touch_errors.hpp) along one path (contact_path.hpp), for each
//             volume, algorithm and n: K 500 N/m, B 0, 1 voxel deep, 0.1 m/s, 1 kHz
//   harness   the cost of measuring itself, and of a tick that keeps its plane
//   ratio     hri's cost over that of another algorithm, at n = 5, in the same repetitions
//   accuracy  errors along a long path on finer knots
//   strokes   misses of fast strokes (strokes.hpp)
//   effects   force jumps at plane switches, with recovery time (the paper's Figure 6) and without
//   press     errors by noise and depth, over several seeds of noise and path: the median of the seeds' medians, the
//             worst of their other figures, the sum of their counts
//   speed     errors by speed and n
//   table     cost and errors by noise and depth, for the algorithms of the paper's Table 1
//   note      what was left out
// The size of noise is how far its standard deviation moves the surface [voxel]. World frame W. Thread: the caller's;
// nothing else runs. No Vulkan device is opened.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "apps/bench/bench_result.hpp"
#include "apps/bench/log_chart.hpp"
#include "apps/console/progress.hpp"

namespace palpate {

inline constexpr const char* kBall20mm = "phantom:sphere?size=115&spacing=0.5mm";  // radius 19.95 mm, voxels of 0.5 mm
inline constexpr const char* kTubeOf8 = "phantom:knot?size=128x128x64";            // a tube of 8.3 voxels of 1 mm

inline constexpr int kTableRenewal = 5;  // n of the paper's Table 1

// The columns of Table 1, by algorithm, with the paper's titles.
struct TableAlgorithm {
  std::string_view name, title;
};
inline constexpr TableAlgorithm kTableAlgorithms[] = {
    {"hri", "hri"}, {"hri-paper", "Intermediate Repr."}, {"blezek", "Blezek and Robb"}, {"avila", "Avila and Sob."}};

struct ServoBenchRequest {
  std::vector<std::string> volumes = {"phantom:sphere?size=64", "phantom:knot?size=64", "phantom:head?size=128x128x64",
                                      "phantom:lung?size=128x128x64"};
  std::vector<int> renewals = {1, 5, 10, 50};  // n; 1 and 5 are needed for targets
  std::size_t cost_ticks = 5000;               // length of the path whose ticks are timed
  int repetitions = 25;                        // as in CostRequest
  int tick_replays = 9;                        // as in CostRequest
  std::size_t error_ticks = 20000;             // length of the path of part "tick" on which errors are measured
  // Targets are for the first. The second has voxels of 1.6 mm, as phantom:head has, so its surface turns away from an
  // ageing plane 1.6 times more slowly.
  std::vector<std::string> accuracy_volumes = {kTubeOf8, "phantom:knot?size=128x128x64&spacing=1.6mm"};
  std::size_t accuracy_ticks = 100000;
  int strokes = 200;               // for each wall and speed
  std::size_t press_ticks = 5000;  // length of the paths of parts "press" and "speed"
  int press_seeds = 5;
  std::uint64_t seed = 1;

  [[nodiscard]] static ServoBenchRequest quick() {  // under a minute
    return {.cost_ticks = 2000,
            .repetitions = 9,
            .tick_replays = 5,
            .error_ticks = 2000,
            .accuracy_ticks = 10000,
            .strokes = 30,
            .press_ticks = 1000,
            .press_seeds = 1};
  }
};

// Returns rows and targets; the caller adds commit and command. Throws Error(kCancelled) on Ctrl-C.
[[nodiscard]] BenchResult runServoBench(const ServoBenchRequest& request, Progress& progress);

// Adds a target for each promise about the servo. Costs and ratios are medians over the volumes of the run; of four,
// the mean of the middle two. The cost ratio of a volume is the median over repetitions of the ratio within one
// repetition. A promise about an algorithm that took no part is left out, with a note.
void addServoTargets(BenchResult& result);

[[nodiscard]] std::string servoTable(const BenchResult& result);  // all tables; Table 1 and its trial come last

// Table 1 of the paper in its own form, today's figures with the paper's: average time of a tick [us] and the servo
// rate that it allows [kHz], with planes renewed every 5 ticks. The paper measured on an SGI Octane (R10000, 1998).
//
// "Intermediate Representation" is the paper's Figure 2, here hri-paper. The column beside it is hri, which mends it
// and is the program's default. hri-paper-line, the other reading of the text, is only in the tables of algorithms: its
// cost differs from hri-paper's at renewals only. From rows of part "tick"; a dash if there is none.
[[nodiscard]] std::string tableOne(const BenchResult& result);
// The same with noise and depth, from rows of part "table"; "" if there are none.
[[nodiscard]] std::string tableTrial(const BenchResult& result);

// Cost against error: a series for each algorithm, a point for each n.
[[nodiscard]] LogCharts servoCharts(const BenchResult& result);

}  // namespace palpate
