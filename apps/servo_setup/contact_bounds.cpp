// SPDX-License-Identifier: Apache-2.0
#include "apps/servo_setup/contact_bounds.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include <fmt/format.h>

#include "servo/stability/sampled_loop.hpp"

namespace palpate {
namespace {

// Encoders that round make a wall up to 4 / pi stiffer, and its damping as much stronger, for swings of about a step
// (the describing function of a quantiser).
double roundingGain(const Device& device) {
  return device.limits().position_resolution_m > 0 ? 4 / M_PI : 1;
}

// The stiffest wall that the settings can make with this damping. Along the surface friction's spring has none.
Wall stiffestWall(const RigSettings& settings, const Device& device, double damping_Ns_per_m) {
  const double gain = roundingGain(device);
  return {settings.parameters.stiffness_N_per_m * mostStiffening(settings.effects) * gain, damping_Ns_per_m * gain};
}

// The dampings with which the contact's spring acts.
std::vector<double> dampings(const RigSettings& settings) {
  std::vector<double> all = {settings.parameters.damping_Ns_per_m};
  if (holdAside(settings.effects)) all.push_back(0);
  return all;
}

SampledLoop sampledLoop(const LoopParameters& loop, const Device& device, const HandParameters& hand) {
  return {.hand = hand,
          .rate_hz = loop.rate_hz,
          .delay_ticks = device.limits().force_delay_ticks,
          .velocity_cutoff_hz = loop.velocity.name == VelocityParameters{}.name ? loop.velocity.cutoff_hz : 0};
}

// The hand, and the damping, with which the wall may be least stiff.
struct Worst {
  SampledLoop loop;
  double damping_Ns_per_m = 0;
  double settling_N_per_m = std::numeric_limits<double>::infinity();  // of the settings' stiffness
};

Worst worstOf(const RigSettings& settings, const LoopParameters& loop, const Device& device) {
  Worst worst;
  for (const HandParameters& hand : device.hands()) {
    for (const double damping : dampings(settings)) {
      const SampledLoop sampled = sampledLoop(loop, device, hand);
      const double settling = settlingStiffness(sampled, damping * roundingGain(device)) / roundingGain(device) /
                              mostStiffening(settings.effects);
      if (settling < worst.settling_N_per_m) worst = {sampled, damping, settling};
    }
  }
  return worst;
}

// Two digits, towards zero or away from it.
double twoDigits(double value, double (*round)(double)) {
  if (!(value > 0)) return 0;
  const double step = std::pow(10.0, std::floor(std::log10(value)) - 1);
  return round(value / step) * step;
}

// Values with which the wall would settle. A device that sets the pace has its delay whatever the servo's rate.
std::string other(const Worst& worst, const Wall& wall, const DeviceLimits& device) {
  std::string words;
  if (device.sets_pace) return words;
  const double rate_hz = settlingRate(worst.loop, wall);
  if (std::isfinite(rate_hz)) words += fmt::format(", or a rate of {:g} Hz or more", twoDigits(rate_hz, std::ceil));
  SampledLoop earlier = worst.loop;
  while (--earlier.delay_ticks >= 0) {
    if (!settlesSoon(earlier, wall)) continue;
    words += fmt::format(", or a delay of at most {} tick{}", earlier.delay_ticks, earlier.delay_ticks == 1 ? "" : "s");
    break;
  }
  return words;
}

std::string conditionWords(const SampledLoop& loop) {
  return loop.delay_ticks > 0 ? fmt::format("at {:g} Hz and {} tick{} late", loop.rate_hz, loop.delay_ticks,
                                            loop.delay_ticks == 1 ? "" : "s")
                              : fmt::format("at {:g} Hz", loop.rate_hz);
}

std::string stiffnessWarning(const RigSettings& settings, const Worst& worst, const Device& device) {
  const Wall wall = stiffestWall(settings, device, worst.damping_Ns_per_m);
  const double factor = mostStiffening(settings.effects);
  const std::string effects =
      factor > 1 ? fmt::format(", which the effects make up to {:.3g} times as stiff", factor) : std::string();
  const std::string damping = worst.damping_Ns_per_m < settings.parameters.damping_Ns_per_m
                                  ? std::string("along the surface, where friction holds it without damping,")
                                  : fmt::format("with a damping of {:g} N s/m", worst.damping_Ns_per_m);
  return fmt::format(
      "a stiffness of {:g} N/m{} is more than this device can render {}, so the contact {}: {} it settles up to {:g} "
      "N/m; give at most that{}",
      settings.parameters.stiffness_N_per_m, effects, conditionWords(worst.loop),
      isStable(worst.loop, wall) ? "may swing for long" : "will shake", damping,
      twoDigits(worst.settling_N_per_m, std::floor), other(worst, wall, device.limits()));
}

// No wall settles with this damping.
std::string dampingWarning(const RigSettings& settings, const Worst& worst, const Device& device) {
  const double most = dampingBound(worst.loop, kSoftest_N_per_m) / 2;
  return fmt::format(
      "a damping of {:g} N s/m is more than this device can render {}, so the contact will shake at any stiffness; "
      "give at most {:g} N s/m{}",
      settings.parameters.damping_Ns_per_m, conditionWords(worst.loop), twoDigits(most, std::floor),
      other(worst, stiffestWall(settings, device, worst.damping_Ns_per_m), device.limits()));
}

// In the linear loop, in one of the hands: whether it swings on, or for long.
bool shakes(const RigSettings& settings, const LoopParameters& loop, const Device& device) {
  return !std::ranges::all_of(device.hands(), [&](const HandParameters& hand) {
    return std::ranges::all_of(dampings(settings), [&](double damping) {
      return settlesSoon(sampledLoop(loop, device, hand), stiffestWall(settings, device, damping));
    });
  });
}

}  // namespace

bool mayShake(const RigSettings& settings, const LoopParameters& loop, const Device& device) {
  if (device.hands().empty() || !algorithmEntry(settings.algorithm).traits.shows_surface) return true;
  return shakes(settings, loop, device);
}

double renderableStiffness(const RigSettings& settings, const LoopParameters& loop, const Device& device) {
  if (device.hands().empty() || !algorithmEntry(settings.algorithm).traits.shows_surface)
    return std::numeric_limits<double>::infinity();
  return worstOf(settings, loop, device).settling_N_per_m;
}

double usualStiffness(const RigSettings& settings, const LoopParameters& loop, const Device& device) {
  const DeviceLimits limits = device.limits();
  const double asked = settings.parameters.stiffness_N_per_m;
  if (!limits.follows_force) return asked;
  double most = renderableStiffness(settings, loop, device);
  for (const HandParameters& hand : device.hands()) {
    // 2 f / D alone: the other term of that bound is for a wall without damping, and the sampled loop is exact.
    if (hand.device_friction_N > 0 && limits.position_resolution_m > 0)
      most =
          std::min(most, 2 * hand.device_friction_N / limits.position_resolution_m / mostStiffening(settings.effects));
  }
  const double wanted = limits.stiffness_limit_N_per_m > 0 ? limits.stiffness_limit_N_per_m : asked;
  if (!(most > 0)) return wanted;  // no stiffness settles with this damping: boundWarnings() says so
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
  const Worst worst = worstOf(settings, loop, device);
  if (worst.settling_N_per_m > 0) return {stiffnessWarning(settings, worst, device)};
  return {dampingWarning(settings, worst, device)};
}

}  // namespace palpate
