// SPDX-License-Identifier: Apache-2.0
// apps/stability/stability_bench.hpp: `palpate stability`: what a contact can bear, in the form of a bench.
//
// Rows, by their key "part":
//   limit   exact limits of the linear loop and the real servo's (limit_rows.hpp)
//   width   how stiff a surface may be until it shakes, with everything that is not linear (width_rows.hpp)
//   stiff   random stiff walls, and what the running servo does with them (stiff_rows.hpp)
//   extreme named cases at the edge of what a user may set or meet (extreme_rows.hpp)
//   note    what was left out
// Simulated time, no Vulkan: the same seed gives the same rows on every machine. One thread.
#pragma once

#include "apps/bench/benches.hpp"
#include "apps/stability/stability_request.hpp"

namespace palpate {

// Throws Error(kCancelled) on Ctrl-C.
[[nodiscard]] BenchResult runStabilityBench(const StabilityRequest& request, Progress& progress);
[[nodiscard]] std::string stabilityTable(const BenchResult& result);
// The borders in the plane of K and B for each device, and what the controller makes of them.
[[nodiscard]] LogCharts stabilityCharts(const BenchResult& result);

// As an entry of the table of benches.
[[nodiscard]] const Bench& stabilityBench();

}  // namespace palpate
