// SPDX-License-Identifier: Apache-2.0
#include "apps/stability/z_width.hpp"

#include <algorithm>
#include <cmath>

namespace palpate {
namespace {

constexpr double kPressed_s = 0.3, kSlid_s = 0.7, kWatched_s = 0.3;
constexpr double kHeight_m = 0.5e-3, kDepth_m = 1e-3, kSlide_m = 4e-3;

Vec3 handAt(double time_s) {
  const double down = std::clamp(time_s / kPressed_s, 0.0, 1.0);
  const double along = std::clamp((time_s - kPressed_s) / (kSlid_s - kPressed_s), 0.0, 1.0);
  const double angle = along * kSlide_m / WallVolume::kRadius_m;
  const double radius_m = WallVolume::kRadius_m + kHeight_m - down * (kHeight_m + kDepth_m);
  return {radius_m * std::sin(angle), 0, radius_m * std::cos(angle) - WallVolume::kRadius_m};
}

double restTime(const HandParameters& p) {
  const double stopping_s = (p.hand_mass_kg + p.device_mass_kg) / (p.hand_damping_Ns_per_m + p.device_damping_Ns_per_m);
  return std::max(kRest_s, kRestDecays * stopping_s);
}

struct Played {
  double moved_m = 0, force_max_N = 0;
};

Played playAt(const WidthQuestion& question, double stiffness_N_per_m, const WallVolume& volume) {
  WallRun run;
  run.contact = question.contact;
  run.contact.wall.stiffness_N_per_m = stiffness_N_per_m;
  run.device = question.device;
  run.loop.rate_hz = question.rate_hz;
  run.loop.velocity.name = question.velocity;
  run.loop.safety.force_limit_N = question.device.force_limit_N;
  run.loop.safety.stale_window_s = 1e6;
  run.loop.passivity = question.passivity;
  run.loop.instability.act = false;
  run.seconds = kSlid_s + restTime(question.device.dynamics);
  run.hand_W = handAt;
  Vec3 low_W = Vec3::Constant(INFINITY), high_W = -low_W;
  Played played;
  for (const TickRecord& record : play(run, volume)) {
    played.force_max_N = std::max(played.force_max_N, asVec3(record.force_W).norm());
    if (record.time_s < run.seconds - kWatched_s) continue;
    low_W = low_W.cwiseMin(asVec3(record.hip_W));
    high_W = high_W.cwiseMax(asVec3(record.hip_W));
  }
  played.moved_m = (high_W - low_W).maxCoeff();
  return played;
}

}  // namespace

double restlessness(const WidthQuestion& question, double stiffness_N_per_m, const WallVolume& volume) {
  return playAt(question, stiffness_N_per_m, volume).moved_m;
}

Width width(const WidthQuestion& question, const WallVolume& volume) {
  const double step = std::pow(10.0, 1.0 / 8);
  const double quiet_m = std::max(kQuiet_m, kQuietSteps * question.device.encoder_resolution_m);
  Width found;
  const auto isQuiet = [&](double stiffness) {
    const Played played = playAt(question, stiffness, volume);
    if (played.moved_m > quiet_m) return false;
    found.stiffness_N_per_m = stiffness;
    found.force_max_N = std::max(found.force_max_N, played.force_max_N);
    return true;
  };
  double bad = kSoftestTried_N_per_m;
  while (isQuiet(bad)) {
    bad *= step;
    if (bad > kStiffestTried_N_per_m) return {kStiffestTried_N_per_m, found.force_max_N};
  }
  while (found.stiffness_N_per_m > 0 && bad > found.stiffness_N_per_m * (1 + kWidthPrecision)) {
    const double middle = std::sqrt(found.stiffness_N_per_m * bad);
    if (!isQuiet(middle)) bad = middle;
  }
  return found;
}

}  // namespace palpate
