// SPDX-License-Identifier: Apache-2.0
// apps/bench/servo_targets.hpp: what the program promises of its servo, held against the rows of `palpate bench servo`.
//
// Ratios and costs are medians over the volumes of the run (the mean of the middle two, of four); cost ratios are
// medians over repetitions of ratios within one repetition, volume by volume. A promise about an algorithm that took no
// part is left out, with a note.
#pragma once

#include "apps/bench/bench_result.hpp"

namespace palpate {

void addServoTargets(BenchResult& result);

}  // namespace palpate
