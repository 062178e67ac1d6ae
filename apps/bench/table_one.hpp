// SPDX-License-Identifier: Apache-2.0
// apps/bench/table_one.hpp: Table 1 of the paper, in its own form, with today's figures beside the paper's; and a trial
// of it with noise and depth as further columns.
//
// Average time of a tick [us] and the servo rate that it allows [kHz], planes renewed every 5 ticks. The paper measured
// on an SGI Octane (R10000, 1998). Its "Intermediate Representation" is its Figure 2: hri-paper here. hri, which mends
// it and is this program's default, stands beside it; hri-paper-line, the other reading of the text, differs in cost
// from hri-paper at renewals only and has rows of its own in the tables of algorithms.
#pragma once

#include <string>
#include <vector>

#include "apps/bench/bench_result.hpp"
#include "apps/bench/tick_cost.hpp"

namespace palpate {

inline constexpr int kTableRenewal = 5;  // n of the paper's Table 1

// Made from rows of part "tick" with n = 5; a dash for an algorithm that took no part.
[[nodiscard]] std::string tableOne(const BenchResult& result);

struct TableTrialRequest {
  std::vector<std::string> volumes;
  std::vector<double> noises_voxel = {0, 0.25};
  std::vector<double> depths_voxel = {1, 2};  // half of the knot's tube and of the skull
  std::size_t ticks = 2000;
  CostRequest cost = {.repetitions = 15, .tick_replays = 0};
  std::uint64_t seed = 1;
};
// Rows of part "table": cost of a tick of the table's algorithms and what they lose of the contact. No row where a
// volume has no place that can be pressed so deep.
void addTableTrial(const TableTrialRequest& request, BenchResult& result, const BenchProgress& progress);
// Made from them; "" without any.
[[nodiscard]] std::string tableTrial(const BenchResult& result);

}  // namespace palpate
