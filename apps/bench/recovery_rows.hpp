// SPDX-License-Identifier: Apache-2.0
// apps/bench/recovery_rows.hpp: force jumps at plane switches with recovery time (the paper's Figure 6) and without.
//
// A slow hand (0.02 m/s) wanders over the knot with planes renewed seldom, so that switches are felt
// and the contact is steady between them: on a surface of radius R planes n ticks apart err in depth by (v n T)^2 / (2
// R), which recovery keeps for a while, so the mean force of a fast hand must differ by more than this target allows.
#pragma once

#include "apps/bench/bench_result.hpp"
#include "apps/bench/touch_errors.hpp"

namespace palpate {

inline constexpr const char* kRecoveryChoice = "recovery";
inline constexpr int kRecoveryRenewal = 20;  // n [tick]
inline constexpr double kRecoveryTime_s = 0.02;
inline constexpr double kRecoverySpeed_m_per_s = 0.02;

// Rows of part "effects", one for each algorithm that takes effects and each choice; targets for hri. Nothing while
// there is no choice but "none".
void addRecoveryRows(const BenchVolume& volume, std::size_t ticks, std::uint64_t seed, BenchResult& result,
                     const BenchProgress& progress);

}  // namespace palpate
