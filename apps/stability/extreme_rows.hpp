// SPDX-License-Identifier: Apache-2.0
// apps/stability/extreme_rows.hpp: part "extreme" of the stability study: every named case of apps/extreme, what is
// expected of it and what came. Any thread; some seconds.
#pragma once

#include "apps/bench/bench_result.hpp"
#include "apps/bench/columns.hpp"
#include "apps/stability/stability_request.hpp"

namespace palpate {

void addExtremeRows(BenchResult& result, const StudyProgress& progress);
void addExtremeTarget(BenchResult& result);
[[nodiscard]] Table extremeTable();

}  // namespace palpate
