// SPDX-License-Identifier: Apache-2.0
#include "apps/stability/linear_limit.hpp"

#include <algorithm>
#include <cmath>
#include <span>

#include "servo/contact/edit_ease.hpp"

namespace palpate {
namespace {

constexpr double kFirstDepth_m = 5e-3;       // at rest on the softest wall
constexpr double kSteps[] = {0.3, 0.75, 1};  // of stiffness and damping

// The largest second difference of the tool's height; infinity if the tool left the surface or was not pushed.
double swing(std::span<const TickRecord> records) {
  double most_m = 0;
  for (std::size_t k = 1; k + 1 < records.size(); ++k) {
    if (!records[k].in_contact || !(records[k].force_W[2] > 0)) return INFINITY;
    most_m = std::max(most_m, std::abs(records[k - 1].hip_W[2] - 2 * records[k].hip_W[2] + records[k + 1].hip_W[2]));
  }
  return most_m;
}

double watchedTime(const SampledLoop& loop) {
  const double friction = loop.hand.hand_damping_Ns_per_m + loop.hand.device_damping_Ns_per_m;
  const double stopping_s = (loop.hand.hand_mass_kg + loop.hand.device_mass_kg) / friction;
  return std::max({kWatch_s, kWatchTicks / loop.rate_hz, kWatchDecays * stopping_s});
}

// A wall of so much damping does not throw back what lands on it: a tenth of what stops the mass within the tick and
// the delay of the velocity filter.
double landingDamping(const SampledLoop& loop) {
  const double mass_kg = loop.hand.hand_mass_kg + loop.hand.device_mass_kg;
  const double filter_s = loop.velocity_cutoff_hz > 0 ? 1 / (2 * M_PI * loop.velocity_cutoff_hz) : 0;
  return 0.1 * mass_kg / (1 / loop.rate_hz + filter_s);
}

// The second difference of a swing of kStill_m.
double stillSwing(const SampledLoop& loop, double stiffness_N_per_m) {
  const double mass_kg = loop.hand.hand_mass_kg + loop.hand.device_mass_kg;
  return kStill_m * stiffness_N_per_m / mass_kg / (loop.rate_hz * loop.rate_hz);
}

}  // namespace

bool settlesAt(const SimulatedLimit& what, double stiffness_N_per_m, const WallVolume& plane) {
  const double watch_s = watchedTime(what.loop);
  const auto contact = [&](double step) {
    double damping = step * what.damping_Ns_per_m;
    if (step == kSteps[0]) damping = std::min(damping, landingDamping(what.loop));
    return WallContact{.wall = {step * stiffness_N_per_m, damping}, .algorithm = what.algorithm, .n = what.n};
  };
  WallRun run;
  run.contact = contact(kSteps[0]);
  run.device = heldDevice(what.loop.hand);
  run.device.delay_ticks = what.loop.delay_ticks;
  run.loop = limitlessLoop(what.loop.rate_hz);
  run.loop.velocity.cutoff_hz = what.loop.velocity_cutoff_hz;
  run.seconds = watch_s;
  for (const double step : {kSteps[1], kSteps[2]}) {
    run.changes.push_back({run.seconds, contact(step)});
    run.seconds += EditEase::kTime_s + watch_s;
  }
  const auto quarter = static_cast<std::size_t>(watch_s * what.loop.rate_hz / 4);
  run.loop.record_ticks = static_cast<std::int64_t>(2 * quarter);
  // The hand wants to be so deep that it and the softest wall are in balance at kFirstDepth_m.
  const double press_m =
      kFirstDepth_m * (1 + run.contact.wall.stiffness_N_per_m / what.loop.hand.hand_stiffness_N_per_m);
  run.hand_W = [&](double time_s) {
    return Vec3(0, 0, 1e-4 - (press_m + 1e-4) * std::clamp(time_s / (0.5 * watch_s), 0.0, 1.0));
  };

  const std::vector<TickRecord> records = play(run, plane);
  const std::span<const TickRecord> all(records);
  const double last_m = swing(all.last(quarter)), before_m = swing(all.first(quarter));
  return last_m < stillSwing(what.loop, stiffness_N_per_m) || last_m < before_m;
}

// Walls much softer than the limit may pull at the tool, if they are damped much: then they say nothing. So the search
// begins with the stiffest power of ten that settles.
double simulatedLimit(const SimulatedLimit& what, const WallVolume& plane) {
  double good = 0;
  for (double stiffness = 1; stiffness < kStiffest_N_per_m; stiffness *= 10) {
    if (settlesAt(what, stiffness, plane)) good = stiffness;
  }
  if (good == 0) return 0;
  double bad = 10 * good;
  while (bad > good * (1 + kLimitPrecision)) {
    const double middle = std::sqrt(good * bad);
    (settlesAt(what, middle, plane) ? good : bad) = middle;
  }
  return std::sqrt(good * bad);
}

}  // namespace palpate
