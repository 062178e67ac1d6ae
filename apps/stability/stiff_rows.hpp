// SPDX-License-Identifier: Apache-2.0
// apps/stability/stiff_rows.hpp: part "stiff" of the stability study: random stiff trials (stiff_trial.hpp), and what
// became of them.
#pragma once

#include "apps/bench/bench_result.hpp"
#include "apps/bench/columns.hpp"
#include "apps/stability/stability_request.hpp"

namespace palpate {

void addStiffRows(BenchResult& result, const StabilityRequest& request, const StudyProgress& progress);
void addStiffTargets(BenchResult& result);
// Counts by what was expected and what came, and how soon the servo noticed.
[[nodiscard]] std::string stiffTable(const BenchResult& result);

}  // namespace palpate
