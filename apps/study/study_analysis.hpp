// SPDX-License-Identifier: Apache-2.0
// apps/study/study_analysis.hpp: what the rows of studies say: Pareto fronts, what they say about the program's
// defaults, orders of convergence, targets. Any thread. Cost: some passes over the rows.
//
// All of it follows from the rows of the cells alone. So a report that was merged from parts says the same as one of
// the same rows from a single run.
#pragma once

#include <string>
#include <vector>

#include "apps/bench/bench_result.hpp"
#include "apps/study/pareto_front.hpp"
#include "apps/study/study.hpp"

namespace palpate {

// The rows that a plot shows, and which of them are on its front.
struct PlottedRows {
  BenchRows rows;
  std::vector<CostAndError> at;    // of each row
  std::vector<std::size_t> front;  // indices; empty if the plot has none
};
[[nodiscard]] PlottedRows plottedRows(const BenchResult& result, const Study& study, const StudyPlot& plot);
// The words of a row's figures of these keys, one blank apart.
[[nodiscard]] std::string wordsOf(const BenchRow& row, const std::vector<std::string>& keys);

// Whether a result is of a quick run, by its rows of part "shard".
[[nodiscard]] bool isQuick(const BenchResult& result);

// Adds a note for every reason why cells were left out, and one if cells of its shards are missing. Then, for every
// study that has rows: rows of part "front" (the choices of each plot's front by ascending cost), of part "default"
// (whether the default settings are on the front, and what beats them), of part "order" (the fitted order of each
// family, and the theory's), of part "count" (how often something went wrong, and in how many cells), and the targets.
void analyse(BenchResult& result);

}  // namespace palpate
