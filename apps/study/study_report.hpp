// SPDX-License-Identifier: Apache-2.0
// apps/study/study_report.hpp: the report of `palpate bench error`: one HTML file with all plots, fronts, orders,
// targets and cells, which needs nothing but a browser and prints well. Any thread.
#pragma once

#include <string>

#include "apps/bench/bench_result.hpp"

namespace palpate {

[[nodiscard]] std::string errorReport(const BenchResult& result);

}  // namespace palpate
