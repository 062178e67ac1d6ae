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
//   effects   force jumps at plane switches with recovery time (the paper's Figure 6) and without
//   press     errors by noise and depth. Noise is told as how far its standard deviation moves the surface [voxel].
//   Over
//             several seeds, of noise and path, medians are the median seed's, other figures the worst seed's, counts
//             sums
//   speed     errors by speed and n
//   table     cost and errors by noise and depth, of the algorithms of the paper's Table 1
//   note      what was left out
// Frame W. Thread: the caller's; nothing else runs. No Vulkan device is opened.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "apps/bench/bench_result.hpp"
#include "apps/console/progress.hpp"

namespace palpate {

inline constexpr const char* kBall20mm = "phantom:sphere?size=115&spacing=0.5mm";  // radius 19.95 mm, voxels of 0.5 mm
inline constexpr const char* kTubeOf8 = "phantom:knot?size=128x128x64";            // a tube of 8.3 voxels of 1 mm

inline constexpr int kTableRenewal = 5;  // n of the paper's Table 1

// Its columns, by algorithm; titles as the paper has them.
struct TableAlgorithm {
  std::string_view name, title;
};
inline constexpr TableAlgorithm kTableAlgorithms[] = {
    {"hri", "hri"}, {"hri-paper", "Intermediate Repr."}, {"blezek", "Blezek and Robb"}, {"avila", "Avila and Sob."}};

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
  std::vector<std::string> accuracy_volumes = {kTubeOf8, "phantom:knot?size=128x128x64&spacing=1.6mm"};
  std::size_t accuracy_ticks = 100000;
  int strokes = 200;               // for each wall, speed and kind
  std::size_t press_ticks = 5000;  // of the paths with noise, depth and speed
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

// Fills rows and targets; who and where (commit, command) is the caller's. Stops with Error(kCancelled) on Ctrl-C.
[[nodiscard]] BenchResult runServoBench(const ServoBenchRequest& request, Progress& progress);

// What the program promises of its servo, held against the rows. Ratios and costs are medians over the volumes of the
// run (the mean of the middle two, of four); cost ratios are medians over repetitions of ratios within one repetition,
// volume by volume. A promise about an algorithm that took no part is left out, with a note.
void addServoTargets(BenchResult& result);

[[nodiscard]] std::string servoTable(const BenchResult& result);  // Table 1 and its trial behind the others

// Table 1 of the paper, in its own form, with today's figures beside the paper's: average time of a tick [us] and the
// servo rate that it allows [kHz], planes renewed every 5 ticks. The paper measured on an SGI Octane (R10000, 1998).
// Its "Intermediate Representation" is its Figure 2: hri-paper here. hri, which mends it and is this program's default,
// stands beside it; hri-paper-line, the other reading of the text, differs in cost from hri-paper at renewals only and
// has rows of its own in the tables of algorithms. Made from rows of part "tick"; a dash for who took no part.
[[nodiscard]] std::string tableOne(const BenchResult& result);
// The same with noise and depth, from rows of part "table"; "" without any.
[[nodiscard]] std::string tableTrial(const BenchResult& result);

// Cost against error, a series an algorithm, a point an n.
[[nodiscard]] std::string servoChart(const BenchResult& result);

}  // namespace palpate
