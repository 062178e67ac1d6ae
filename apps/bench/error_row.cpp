// SPDX-License-Identifier: Apache-2.0
#include "apps/bench/error_row.hpp"

#include <limits>

namespace palpate {

BenchRow errorRow(const TouchErrors& errors) {
  constexpr double kNone = std::numeric_limits<double>::quiet_NaN();
  const auto of = [&](const Percentiles& all, double figure) { return all.count > 0 ? figure : kNone; };
  const Percentiles& vhip = errors.vhip_voxel;
  const Percentiles& force = errors.force_percent;
  const Percentiles& angle = errors.angle_deg;
  return {{"ticks", errors.ticks},
          {"contact_ticks", errors.contact_ticks},
          {"vhip_error_median_voxel", of(vhip, vhip.p50)},
          {"vhip_error_p99_voxel", of(vhip, vhip.p99)},
          {"force_error_median_percent", of(force, force.p50)},
          {"force_error_p99_percent", of(force, force.p99)},
          {"force_off_max", of(force, errors.force_off_max)},
          {"force_angle_median_deg", of(angle, angle.p50)},
          {"force_angle_p99_deg", of(angle, angle.p99)},
          {"force_angle_max_deg", of(angle, angle.max)},
          {"force_jump_max_N", errors.force_jump_max_N},
          {"exact_force_jump_max_N", errors.exact_force_jump_max_N},
          {"missed_ticks", errors.missed_ticks},
          {"fading_fault_ticks", errors.fading_ticks},
          {"fall_throughs", errors.falls}};
}

std::vector<Entrant> makeEntrantsOnce(const BenchVolume& volume, const std::vector<int>& renewals) {
  std::vector<Entrant> list = makeEntrants(volume, renewals).list;
  std::erase_if(list, [&](const Entrant& e) { return !e.traits.renews_planes && e.n != renewals.front(); });
  return list;
}

}  // namespace palpate
