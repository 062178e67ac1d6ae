// SPDX-License-Identifier: Apache-2.0
// apps/study/cell.hpp: a cell of a study: one point in the space of parameters, which can be measured again and again,
// alone or beside others, on this machine or on another.
//
// A study is a list of cells. The list follows from the settings alone, never from the machine: a cell that cannot be
// measured here (a library is not installed) is in it all the same, and says so when it runs. So every machine cuts the
// same list into the same shards. Thread: one.
#pragma once

#include <functional>
#include <string>
#include <utility>
#include <vector>

#include "apps/bench/bench_result.hpp"

namespace palpate {

// What one run of a cell found.
struct CellFigures {
  BenchRow errors = {};  // and all else that does not depend on the machine's speed: the same in every run
  std::vector<std::pair<std::string, double>> costs = {};  // differ from run to run; the key holds the unit
};

struct StudyCell {
  BenchRow parameters;  // its place; no other cell of the study has the same
  // Runs it once. What it shares with other cells is made in the first run that needs it. Throws Error where it cannot
  // be measured here, with kCancelled on Ctrl-C.
  std::function<CellFigures()> run;
};

// "algorithm=hri n_ticks=5": the parameters as text, by which cells of different runs are told apart and sorted.
[[nodiscard]] std::string cellKey(const BenchRow& parameters);

}  // namespace palpate
