// SPDX-License-Identifier: Apache-2.0
// apps/stability/width_rows.hpp: part "width" of the stability study: how stiff a surface may be until it shakes
// (z_width.hpp), for each study device in three hands, with everything that a scene may choose varied by itself:
// algorithm, n, velocity estimate, contact effect, recovery, passivity controller.
//
// A quick study has all of them for the default device and hand, and the controller alone for the other devices.
#pragma once

#include "apps/bench/bench_result.hpp"
#include "apps/bench/columns.hpp"
#include "apps/stability/stability_request.hpp"

namespace palpate {

void addWidthRows(BenchResult& result, const StabilityRequest& request, const StudyProgress& progress);
void addWidthTargets(BenchResult& result);
[[nodiscard]] const Table& widthTable();

}  // namespace palpate
