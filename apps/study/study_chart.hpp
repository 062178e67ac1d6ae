// SPDX-License-Identifier: Apache-2.0
// apps/study/study_chart.hpp: the plots of a study as one SVG picture. Any thread.
#pragma once

#include <string>
#include <vector>

#include "apps/bench/bench_result.hpp"
#include "apps/bench/log_chart.hpp"
#include "apps/study/study.hpp"

namespace palpate {

inline constexpr std::size_t kPlotsAcross = 3;  // beside each other

// One panel for each plot that has rows. The front has rings; marks on it and that of the default have their labels.
[[nodiscard]] std::vector<ChartPanel> panelsOf(const BenchResult& result, const Study& study, bool quick);
// A chart of these panels; none without them.
[[nodiscard]] LogCharts studyCharts(const BenchResult& result, const Study& study, bool quick);
// The charts of all studies.
[[nodiscard]] LogCharts errorCharts(const BenchResult& result);

}  // namespace palpate
