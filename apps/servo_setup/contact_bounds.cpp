// SPDX-License-Identifier: Apache-2.0
#include "apps/servo_setup/contact_bounds.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include <fmt/format.h>

#include "servo/stability/sampled_loop.hpp"

namespace palpate {
namespace {

Wall stiffestWall(const RigSettings& settings) {
  double factor = settings.effects.stiffness_by_density.empty() ? 1 : 0;
  for (const StiffnessRow& row : settings.effects.stiffness_by_density) factor = std::max(factor, row.factor);
  return {settings.parameters.stiffness_N_per_m * factor, settings.parameters.damping_Ns_per_m};
}

SampledLoop sampledLoop(const LoopParameters& loop, const Device& device, const HandParameters& hand) {
  return {.hand = hand,
          .rate_hz = loop.rate_hz,
          .delay_ticks = device.limits().force_delay_ticks,
          .velocity_cutoff_hz = loop.velocity.name == VelocityParameters{}.name ? loop.velocity.cutoff_hz : 0};
}

// The hand in which the wall of this damping may be least stiff.
SampledLoop worstLoop(const LoopParameters& loop, const Device& device, double damping_Ns_per_m) {
  std::vector<SampledLoop> all;
  for (const HandParameters& hand : device.hands()) all.push_back(sampledLoop(loop, device, hand));
  return *std::min_element(all.begin(), all.end(), [&](const SampledLoop& a, const SampledLoop& b) {
    return stiffnessBound(a, damping_Ns_per_m) < stiffnessBound(b, damping_Ns_per_m);
  });
}

// Two digits, towards zero or away from it.
double twoDigits(double value, double (*round)(double)) {
  if (!(value > 0)) return 0;
  const double step = std::pow(10.0, std::floor(std::log10(value)) - 1);
  return round(value / step) * step;
}

// A device that sets the pace has its delay whatever the servo's rate.
std::string other(const SampledLoop& loop, const Wall& wall, const DeviceLimits& device) {
  std::string words;
  if (device.sets_pace) return words;
  const double rate_hz = rateBound(loop, wall);
  if (std::isfinite(rate_hz)) words += fmt::format(", or a rate of {:g} Hz or more", twoDigits(rate_hz, std::ceil));
  const int delay = delayBound(loop, wall, loop.delay_ticks);
  if (delay >= 0 && delay < loop.delay_ticks)
    words += fmt::format(", or a delay of at most {} tick{}", delay, delay == 1 ? "" : "s");
  return words;
}

std::string conditionWords(const SampledLoop& loop) {
  return loop.delay_ticks > 0 ? fmt::format("at {:g} Hz and {} tick{} late", loop.rate_hz, loop.delay_ticks,
                                            loop.delay_ticks == 1 ? "" : "s")
                              : fmt::format("at {:g} Hz", loop.rate_hz);
}

std::string stiffnessWarning(const SampledLoop& loop, const Wall& wall, double bound, const DeviceLimits& device) {
  return fmt::format(
      "a stiffness of {:g} N/m is more than this device can render {}, so the contact will shake: with a damping of "
      "{:g} N s/m it is stable up to {:g} N/m; give at most that{}",
      wall.stiffness_N_per_m, conditionWords(loop), wall.damping_Ns_per_m, twoDigits(bound, std::floor),
      other(loop, wall, device));
}

std::string dampingWarning(const SampledLoop& loop, const Wall& wall, const DeviceLimits& device) {
  const double most = dampingBound(loop, kSoftest_N_per_m);
  return fmt::format(
      "a damping of {:g} N s/m is more than this device can render {}, so the contact will shake at any stiffness; "
      "give "
      "at most {:g} N s/m{}",
      wall.damping_Ns_per_m, conditionWords(loop), twoDigits(most, std::floor), other(loop, wall, device));
}

// In the linear loop, in one of the hands.
bool shakes(const RigSettings& settings, const LoopParameters& loop, const Device& device) {
  const Wall wall = stiffestWall(settings);
  return !std::ranges::all_of(
      device.hands(), [&](const HandParameters& hand) { return isStable(sampledLoop(loop, device, hand), wall); });
}

}  // namespace

bool mayShake(const RigSettings& settings, const LoopParameters& loop, const Device& device) {
  if (device.hands().empty() || !algorithmEntry(settings.algorithm).traits.shows_surface) return true;
  return shakes(settings, loop, device);
}

double renderableStiffness(const RigSettings& settings, const LoopParameters& loop, const Device& device) {
  if (device.hands().empty() || !algorithmEntry(settings.algorithm).traits.shows_surface)
    return std::numeric_limits<double>::infinity();
  const double damping = settings.parameters.damping_Ns_per_m;
  return stiffnessBound(worstLoop(loop, device, damping), damping);
}

double usualStiffness(const RigSettings& settings, const LoopParameters& loop, const Device& device) {
  const DeviceLimits limits = device.limits();
  const double asked = settings.parameters.stiffness_N_per_m;
  if (!limits.follows_force) return asked;
  double most = renderableStiffness(settings, loop, device);
  for (const HandParameters& hand : device.hands()) {
    // 2 f / D alone: the other term of that bound is for a wall without damping, and the sampled loop is exact.
    if (hand.device_friction_N > 0 && limits.position_resolution_m > 0)
      most = std::min(most, 2 * hand.device_friction_N / limits.position_resolution_m);
  }
  const double wanted = limits.stiffness_limit_N_per_m > 0 ? limits.stiffness_limit_N_per_m : asked;
  if (asked > 0) most /= stiffestWall(settings).stiffness_N_per_m / asked;  // where the density makes it stiffer, too
  if (!(most > 0)) return wanted;  // no stiffness is stable with this damping: boundWarnings() says so
  return most < wanted ? twoDigits(most, std::floor) : wanted;
}

double usualDamping(const RigSettings& settings, const LoopParameters& loop, const Device& device) {
  const double asked = settings.parameters.damping_Ns_per_m;
  if (!device.limits().follows_force || !algorithmEntry(settings.algorithm).traits.shows_surface) return asked;
  double most = asked;
  for (const HandParameters& hand : device.hands())
    most = std::min(most, 0.5 * dampingBound(sampledLoop(loop, device, hand), kSoftest_N_per_m));
  return most < asked ? twoDigits(most, std::floor) : asked;
}

std::vector<std::string> boundWarnings(const RigSettings& settings, const LoopParameters& loop, const Device& device) {
  if (device.hands().empty() || loop.passivity.control) return {};
  if (!algorithmEntry(settings.algorithm).traits.shows_surface || !shakes(settings, loop, device)) return {};
  const Wall wall = stiffestWall(settings);
  const SampledLoop worst = worstLoop(loop, device, wall.damping_Ns_per_m);
  const double bound = stiffnessBound(worst, wall.damping_Ns_per_m);
  if (bound > 0) return {stiffnessWarning(worst, wall, bound, device.limits())};
  return {dampingWarning(worst, wall, device.limits())};
}

}  // namespace palpate
