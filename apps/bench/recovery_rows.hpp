// SPDX-License-Identifier: Apache-2.0
// apps/bench/recovery_rows.hpp: force jumps at plane switches with recovery time (the paper's Figure 6) and without.
//
// Under two conditions, 1 voxel deep each, with a recovery of 20 ms:
//   n = 20, 0.02 m/s: the targets. Planes are renewed seldom, so that switches are felt, and the contact is steady
//     between them: on a surface of radius R planes n ticks apart err in depth by (v n T)^2 / (2 R), which recovery
//     keeps for a while, so the mean force of a fast hand must differ by more than this target allows.
//   n = 50, 0.1 m/s: where recovery matters. So seldom the paper renewed its planes (section 4: "50 to 10 times slower
//     than the servo loop"), and its hand moved as one does. No target: an algorithm that renews a plane before it is
//     that wrong has little to recover from, and one that does not cannot be made right by it.
#pragma once

#include <span>

#include "apps/bench/bench_result.hpp"
#include "apps/bench/touch_errors.hpp"

namespace palpate {

inline constexpr const char* kRecoveryChoice = "recovery";
inline constexpr double kRecoveryTime_s = 0.02;

struct RecoveryCondition {
  int n_ticks = 1;
  double speed_m_per_s = 0.1;
  double depth_voxel = 1;
};
// The first is the targets'.
[[nodiscard]] std::span<const RecoveryCondition> recoveryConditions();

// The targets look where the exact surface is concave along the tool's way, where the paper met its discontinuities
// (section 4). Rows of part "effects", one for each condition, algorithm that takes effects and choice of them; targets
// for hri, which state the condition. Nothing while there is no choice but "none".
void addRecoveryRows(const BenchVolume& volume, std::size_t ticks, std::uint64_t seed, BenchResult& result,
                     const BenchProgress& progress);

}  // namespace palpate
