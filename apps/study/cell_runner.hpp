// SPDX-License-Identifier: Apache-2.0
// apps/study/cell_runner.hpp: runs the cells of a study, round by round, so that other load on the machine meets all
// alike.
//
// Each round runs every cell once, in an order that is drawn anew from the seed. The first round makes what the cells
// need and warms caches and kernels; its times do not count, unless nothing came after it. Errors may not differ from
// round to round. One thread.
#pragma once

#include <cstdint>
#include <functional>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "apps/study/cell.hpp"

namespace palpate {

struct RunPlan {
  int rounds = 5;  // whose times count
  std::uint64_t seed = 1;
};

// What became of a cell.
struct CellRun {
  BenchRow errors;                                                 // of its first run
  std::vector<std::pair<std::string, std::vector<double>>> costs;  // of each round that counts
  bool repeats = true;                                             // the errors were the same in every round
  std::string left_out;  // why it cannot be measured here; empty: it was, or the work was stopped before
  [[nodiscard]] bool measured() const noexcept { return !costs.empty() || !errors.empty(); }
};

struct CellRuns {
  std::vector<CellRun> cells;  // one for each cell
  bool stopped = false;        // by the user; what was measured until then is there
};

// How far the work is: the share that is done, and the time that the rest will take [s], as the cells took it so far.
struct RunState {
  int round = 0;  // 0: warming up
  double share = 0, left_s = 0;
};

// `stop` is asked before every cell. A cell that throws Error(kCancelled) stops the work too; one that throws anything
// else is left out from then on, and what it found before is dropped.
[[nodiscard]] CellRuns runCells(std::span<const StudyCell* const> cells, const RunPlan& plan,
                                const std::function<bool()>& stop, const std::function<void(const RunState&)>& tell);

// The order in which a round runs `count` cells: a permutation of 0 ... count - 1.
[[nodiscard]] std::vector<std::size_t> orderOfRound(std::size_t count, std::uint64_t seed, int round);

}  // namespace palpate
