// SPDX-License-Identifier: Apache-2.0
#include "apps/bench/recovery_rows.hpp"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

namespace palpate {
namespace {

constexpr RecoveryCondition kConditions[] = {{.n_ticks = 20, .speed_m_per_s = 0.02, .depth_voxel = 1},
                                             {.n_ticks = 50, .speed_m_per_s = 0.1, .depth_voxel = 1}};

const BenchRow* rowOf(const BenchResult& result, const RecoveryCondition& condition, const std::string& effects) {
  const auto at = std::find_if(result.rows.begin(), result.rows.end(), [&](const BenchRow& row) {
    return textOf(row, "part") == "effects" && textOf(row, "algorithm") == "hri" && textOf(row, "effects") == effects &&
           figureOf(row, "n_ticks") == condition.n_ticks && figureOf(row, "speed_m_per_s") == condition.speed_m_per_s;
  });
  return at == result.rows.end() ? nullptr : &*at;
}

void addRows(const RecoveryCondition& condition, const BenchVolume& volume, std::size_t ticks, std::uint64_t seed,
             BenchResult& result, const BenchProgress& progress) {
  std::vector<Entrant> entrants = makeEntrantsWithEffects(volume, condition.n_ticks);
  const ContactPath path = contactPath(volume, {.speed_m_per_s = condition.speed_m_per_s,
                                                .rate_hz = kBenchRate_hz,
                                                .depth_voxel = condition.depth_voxel,
                                                .ticks = ticks,
                                                .seed = seed});
  const std::vector<TouchErrors> errors = touchErrors(volume, path, entrants, progress);
  for (std::size_t e = 0; e < entrants.size(); ++e) {
    result.rows.push_back({{"part", "effects"},
                           {"volume", volume.name()},
                           {"algorithm", entrants[e].algorithm},
                           {"n_ticks", std::int64_t{entrants[e].n}},
                           {"effects", entrants[e].effects},
                           {"recovery_s", kRecoveryTime_s},
                           {"speed_m_per_s", condition.speed_m_per_s},
                           {"depth_voxel", condition.depth_voxel},
                           {"seed", static_cast<std::int64_t>(seed)},
                           {"ticks", errors[e].ticks},
                           {"force_jump_max_N", errors[e].force_jump_max_N},
                           {"force_jump_concave_max_N", errors[e].force_jump_concave_max_N},
                           {"force_mean_N", errors[e].force_mean_N},
                           {"missed_ticks", errors[e].missed_ticks}});
  }
}

}  // namespace

std::span<const RecoveryCondition> recoveryConditions() {
  return kConditions;
}

void addRecoveryRows(const BenchVolume& volume, std::size_t ticks, std::uint64_t seed, BenchResult& result,
                     const BenchProgress& progress) {
  if (effectChoices().size() < 2) return;
  for (const RecoveryCondition& condition : kConditions) addRows(condition, volume, ticks, seed, result, progress);
  const RecoveryCondition& promised = kConditions[0];
  const BenchRow* off = rowOf(result, promised, "none");
  const BenchRow* on = rowOf(result, promised, kRecoveryChoice);
  if (off == nullptr || on == nullptr) return;
  const auto ratio = [&](const char* key) { return figureOf(*on, key) / figureOf(*off, key); };
  const double jump = ratio("force_jump_concave_max_N");
  const double mean = std::abs(ratio("force_mean_N") - 1);
  const std::string where =
      fmt::format("hri, knot 128x128x64, n={}, {:g} m/s, {:g} voxel deep, {:g} ms", promised.n_ticks,
                  promised.speed_m_per_s, promised.depth_voxel, 1e3 * kRecoveryTime_s);
  result.targets.push_back(
      {fmt::format("recovery on / off, largest force jump per tick on concave regions ({}) [-]", where), jump, 0.1});
  result.targets.push_back({fmt::format("recovery on / off, mean force differs by ({}) [-]", where), mean, 0.01});
}

}  // namespace palpate
