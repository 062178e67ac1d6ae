// SPDX-License-Identifier: Apache-2.0
// apps/bench/table_one.hpp: Table 1 of the paper, in its own form, with today's figures beside the paper's.
//
// Average time of a tick [us] and the servo rate that it allows [kHz], planes renewed every 5 ticks. The paper measured
// on an SGI Octane (R10000, 1998).
#pragma once

#include <string>

#include "apps/bench/bench_result.hpp"

namespace palpate {

// Made from rows of part "tick" with n = 5; a dash for an algorithm that took no part.
[[nodiscard]] std::string tableOne(const BenchResult& result);

}  // namespace palpate
