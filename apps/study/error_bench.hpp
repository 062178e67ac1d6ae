// SPDX-License-Identifier: Apache-2.0
// apps/study/error_bench.hpp: `palpate bench error`: error against run time, of every part of the program and beside
// its rivals. Truth is a formula everywhere.
//
// Rows, by their key "part":
//   shard    which part of the cells was measured, and where
//   NAME     of a study ("gradients", "servo", ...; studies.cpp): a row for each cell, with its parameters, its errors,
//            and of each cost the median, the quartiles and the cost in every round
//   front, default, order, count    what follows from the cells (study_analysis.hpp)
//   note     what was left out, and which cells are missing
// A row of a cell that could not be measured has the reason under "left_out".
//
// Ctrl-C ends the work between two cells; the result is then that of the cells that were measured, and says so. One
// thread. Throws Error(kBadInput) on an unknown study.
#pragma once

#include <string>
#include <vector>

#include "apps/bench/benches.hpp"
#include "apps/console/progress.hpp"
#include "apps/study/shard.hpp"
#include "apps/study/study.hpp"

namespace palpate {

struct ErrorBenchRequest {
  StudySettings settings = {};
  std::vector<std::string> studies = {};  // by name; empty: all
  Shard shard = {};
};

[[nodiscard]] BenchResult runErrorBench(const ErrorBenchRequest& request, Progress& progress);

// What the fronts say of the defaults, the orders, and the fronts.
[[nodiscard]] std::string errorTable(const BenchResult& result);

// Its row in the table of benches.
[[nodiscard]] Bench errorBench();

}  // namespace palpate
