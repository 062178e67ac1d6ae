// SPDX-License-Identifier: Apache-2.0
#include "apps/bench/recovery_rows.hpp"

#include <algorithm>
#include <cmath>

namespace palpate {
namespace {

const BenchRow* rowOf(const BenchResult& result, const std::string& effects) {
  const auto at = std::find_if(result.rows.begin(), result.rows.end(), [&](const BenchRow& row) {
    return textOf(row, "part") == "effects" && textOf(row, "algorithm") == "hri" && textOf(row, "effects") == effects;
  });
  return at == result.rows.end() ? nullptr : &*at;
}

}  // namespace

void addRecoveryRows(const BenchVolume& volume, std::size_t ticks, std::uint64_t seed, BenchResult& result,
                     const BenchProgress& progress) {
  std::vector<Entrant> entrants = makeEntrantsWithEffects(volume, kRecoveryRenewal);
  if (entrants.empty()) return;
  const ContactPath path = contactPath(
      volume, {.speed_m_per_s = kRecoverySpeed_m_per_s, .rate_hz = kBenchRate_hz, .ticks = ticks, .seed = seed});
  const std::vector<TouchErrors> errors = touchErrors(volume, path, entrants, progress);
  for (std::size_t e = 0; e < entrants.size(); ++e) {
    result.rows.push_back({{"part", "effects"},
                           {"volume", volume.name()},
                           {"algorithm", entrants[e].algorithm},
                           {"n_ticks", std::int64_t{entrants[e].n}},
                           {"effects", entrants[e].effects},
                           {"speed_m_per_s", kRecoverySpeed_m_per_s},
                           {"seed", static_cast<std::int64_t>(seed)},
                           {"ticks", errors[e].ticks},
                           {"force_jump_max_N", errors[e].force_jump_max_N},
                           {"force_mean_N", errors[e].force_mean_N}});
  }
  const BenchRow* off = rowOf(result, "none");
  const BenchRow* on = rowOf(result, kRecoveryChoice);
  if (off == nullptr || on == nullptr) return;
  const auto ratio = [&](const char* key) { return figureOf(*on, key) / figureOf(*off, key); };
  const double jump = ratio("force_jump_max_N");
  const double mean = std::abs(ratio("force_mean_N") - 1);
  result.targets.push_back({"recovery on / off, largest force jump per tick [-]", jump, 0.1});
  result.targets.push_back({"recovery on / off, mean force differs by [-]", mean, 0.01});
}

}  // namespace palpate
