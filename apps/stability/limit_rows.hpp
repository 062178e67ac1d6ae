// SPDX-License-Identifier: Apache-2.0
// apps/stability/limit_rows.hpp: part "limit" of the stability study: the border of stability in the plane of K and B,
// exact and by the real servo, with the passivity bounds beside it; for each study device, hand and delay.
//
// Encoders and limits of the force are left out here, as in the linear loop. Rate: 1 kHz.
#pragma once

#include "apps/bench/bench_result.hpp"
#include "apps/bench/columns.hpp"
#include "apps/stability/stability_request.hpp"

namespace palpate {

inline constexpr double kStudyRate_hz = 1000;

void addLimitRows(BenchResult& result, const StabilityRequest& request, const StudyProgress& progress);
void addLimitTargets(BenchResult& result);
[[nodiscard]] const Table& limitTable();

}  // namespace palpate
