// SPDX-License-Identifier: Apache-2.0
// apps/bench/recovery_rows.hpp: force jumps at plane switches with recovery time (the paper's Figure 6) and without.
//
// The place for it stands ready: effectChoices() (entrants.cpp) gets a row named kRecoveryChoice, and the rows and both
// targets appear. On a fast path over the knot with planes renewed seldom, so that switches are felt.
#pragma once

#include "apps/bench/bench_result.hpp"
#include "apps/bench/touch_errors.hpp"

namespace palpate {

inline constexpr const char* kRecoveryChoice = "recovery";
inline constexpr int kRecoveryRenewal = 50;  // n [tick]

// Rows of part "effects", one for each algorithm that takes effects and each choice; targets for hri. Nothing while
// there is no choice but "none".
void addRecoveryRows(const BenchVolume& volume, const ContactPath& path, BenchResult& result,
                     const BenchProgress& progress);

}  // namespace palpate
