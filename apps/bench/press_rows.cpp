// SPDX-License-Identifier: Apache-2.0
#include "apps/bench/press_rows.hpp"

#include <algorithm>

#include "apps/bench/error_row.hpp"

namespace palpate {
namespace {

// Of one entrant, from all its seeds.
TouchErrors together(const std::vector<TouchErrors>& seeds) {
  TouchErrors all = seeds.front();
  for (const auto part : {&TouchErrors::vhip_voxel, &TouchErrors::force_percent, &TouchErrors::angle_deg}) {
    std::vector<double> medians;
    for (const TouchErrors& e : seeds) {
      if ((e.*part).count > 0) medians.push_back((e.*part).p50);
    }
    std::sort(medians.begin(), medians.end());
    (all.*part).p50 = quantile(medians, 0.5);
  }
  for (std::size_t i = 1; i < seeds.size(); ++i) {
    const TouchErrors& e = seeds[i];
    all.ticks += e.ticks;
    all.contact_ticks += e.contact_ticks;
    all.missed_ticks += e.missed_ticks;
    all.falls += e.falls;
    all.fading_ticks += e.fading_ticks;
    for (const auto part : {&TouchErrors::vhip_voxel, &TouchErrors::force_percent, &TouchErrors::angle_deg}) {
      (all.*part).count += (e.*part).count;
      (all.*part).p99 = std::max((all.*part).p99, (e.*part).p99);
      (all.*part).max = std::max((all.*part).max, (e.*part).max);
    }
    for (const auto part :
         {&TouchErrors::force_off_max, &TouchErrors::force_jump_max_N, &TouchErrors::exact_force_jump_max_N}) {
      all.*part = std::max(all.*part, e.*part);
    }
  }
  return all;
}

BenchRow rowOf(const char* part, const std::string& volume, const Entrant& entrant) {
  return {{"part", part}, {"volume", volume}, {"algorithm", entrant.algorithm}, {"n_ticks", std::int64_t{entrant.n}}};
}

}  // namespace

void addPressRows(const PressRequest& request, BenchResult& result, const BenchProgress& progress) {
  const double steps = static_cast<double>(request.noises_voxel.size()) * static_cast<double>(request.seeds);
  double step = 0;
  for (const double noise_voxel : request.noises_voxel) {
    const int seeds = noise_voxel > 0 ? request.seeds : 1;
    std::vector<Entrant> entrants;
    std::vector<std::vector<std::vector<TouchErrors>>> errors(request.depths_voxel.size());  // depth, entrant, seed
    for (int i = 0; i < seeds; ++i) {
      const std::uint64_t seed = request.first_seed + static_cast<std::uint64_t>(i);
      const BenchVolume volume(withNoise(request.volume, noise_voxel, seed));
      entrants = makeEntrantsOnce(volume, request.renewals);
      for (std::size_t d = 0; d < errors.size(); ++d) {
        progress(std::min(1.0, step / steps));
        const ContactPath path = contactPath(
            volume,
            {.rate_hz = kBenchRate_hz, .depth_voxel = request.depths_voxel[d], .ticks = request.ticks, .seed = seed});
        const auto found = touchErrors(
            volume, path, entrants, [&](double) { progress(std::min(1.0, step / steps)); },
            missDepth_voxel(noise_voxel));
        errors[d].resize(entrants.size());
        for (std::size_t e = 0; e < entrants.size(); ++e) errors[d][e].push_back(found[e]);
      }
      step += 1;
    }
    for (std::size_t d = 0; d < errors.size(); ++d) {
      for (std::size_t e = 0; e < entrants.size(); ++e) {
        BenchRow row = rowOf("press", request.volume, entrants[e]);
        addCells(row, {{"noise_voxel", noise_voxel},
                       {"depth_voxel", request.depths_voxel[d]},
                       {"seed", static_cast<std::int64_t>(request.first_seed)},
                       {"seeds", std::int64_t{seeds}}});
        addCells(row, errorRow(together(errors[d][e])));
        result.rows.push_back(std::move(row));
      }
    }
  }
}

void addSpeedRows(const SpeedRequest& request, BenchResult& result, const BenchProgress& progress) {
  const BenchVolume volume(request.volume);
  double step = 0;
  for (const double speed : request.speeds_m_per_s) {
    std::vector<Entrant> entrants = makeEntrantsOnce(volume, request.renewals);
    const ContactPath path = contactPath(volume, {.speed_m_per_s = speed,
                                                  .rate_hz = kBenchRate_hz,
                                                  .depth_voxel = request.depth_voxel,
                                                  .ticks = request.ticks,
                                                  .seed = request.seed});
    const auto share = [&](double part) {
      progress((step + part) / static_cast<double>(request.speeds_m_per_s.size()));
    };
    const auto errors = touchErrors(volume, path, entrants, share);
    for (std::size_t e = 0; e < entrants.size(); ++e) {
      BenchRow row = rowOf("speed", request.volume, entrants[e]);
      addCells(row, {{"speed_m_per_s", speed},
                     {"depth_voxel", request.depth_voxel},
                     {"seed", static_cast<std::int64_t>(request.seed)}});
      addCells(row, errorRow(errors[e]));
      result.rows.push_back(std::move(row));
    }
    step += 1;
  }
}

}  // namespace palpate
