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

// A direction in which the contact holds the tool: by how much of the settings' stiffness, and how damped.
struct Way {
  double factor = 1;
  double damping_Ns_per_m = 0;
};

// Along the normal; along the surface too where effects hold the tool, without damping.
std::vector<Way> ways(const RigSettings& settings) {
  std::vector<Way> all = {{mostStiffening(settings.effects), settings.parameters.damping_Ns_per_m}};
  const double aside = mostStiffeningAside(settings.effects);
  if (aside > 0) all.push_back({aside, 0});
  return all;
}

Wall wallOf(const RigSettings& settings, const Way& way, double gain = 1) {
  return {settings.parameters.stiffness_N_per_m * way.factor * gain, way.damping_Ns_per_m * gain};
}

// What a hand and a device's bearings have at least of dry friction, where the device states less [N]. Measured: of
// 12,000 random contacts those that swung on had jumps of 0.06 N and more (docs/stability.md).
constexpr double kLeastFriction_N = 0.02;

// Swings of a few steps of the encoders know no damping, since a velocity that is rounded comes in steps, too. So they
// go on where the wall is unstable without its damping, unless dry friction quiets them. It does where a step makes the
// force jump by at most twice as much [N] (Abbott and Okamura 2005, for walls without damping).
double quietJump(const SampledLoop& loop) {
  return 2 * std::max(loop.hand.device_friction_N, kLeastFriction_N);
}

// A damping that answers a step by more than this many times as much shakes whatever else is true: more than was tried.
constexpr double kMostJumps = 10;

bool isDampedQuietly(const SampledLoop& loop, double damping_Ns_per_m, double resolution_m) {
  return forceOfAStep(loop, {0, damping_Ns_per_m}, resolution_m) <= kMostJumps * quietJump(loop);
}

// Whether such swings die.
bool isQuiet(const SampledLoop& loop, const Wall& wall, double resolution_m) {
  constexpr double kRounding = 1e-9;  // of quietStiffness()
  if (!isDampedQuietly(loop, wall.damping_Ns_per_m, resolution_m)) return false;
  return forceOfAStep(loop, wall, resolution_m) <= quietJump(loop) * (1 + kRounding) ||
         isStable(loop, {wall.stiffness_N_per_m * (1 - kRounding), 0});
}

// The stiffness up to which they do; 0: none.
double quietStiffness(const SampledLoop& loop, double damping_Ns_per_m, double resolution_m) {
  if (!(resolution_m > 0)) return std::numeric_limits<double>::infinity();
  if (!isDampedQuietly(loop, damping_Ns_per_m, resolution_m)) return 0;
  const double by_friction = (quietJump(loop) - forceOfAStep(loop, {0, damping_Ns_per_m}, resolution_m)) / resolution_m;
  return std::max(by_friction, stiffnessBound(loop, 0));
}

SampledLoop sampledLoop(const LoopParameters& loop, const Device& device, const HandParameters& hand) {
  return {.hand = hand,
          .rate_hz = loop.rate_hz,
          .delay_ticks = device.limits().force_delay_ticks,
          .velocity_cutoff_hz = loop.velocity.name == VelocityParameters{}.name ? loop.velocity.cutoff_hz : 0};
}

// The hand, and the way, in which the contact may be least stiff.
struct Worst {
  SampledLoop loop;
  Way way;
  double settling_N_per_m = std::numeric_limits<double>::infinity();  // of the settings' stiffness
  bool by_encoders = false;                                           // their steps bound it, not the linear loop
};

Worst worstOf(const RigSettings& settings, const LoopParameters& loop, const Device& device) {
  Worst worst;
  const double resolution_m = device.limits().position_resolution_m, gain = roundingGain(device);
  for (const HandParameters& hand : device.hands()) {
    for (const Way& way : ways(settings)) {
      const SampledLoop sampled = sampledLoop(loop, device, hand);
      const double linear = settlingStiffness(sampled, way.damping_Ns_per_m * gain) / gain / way.factor;
      const double quiet = quietStiffness(sampled, way.damping_Ns_per_m, resolution_m) / way.factor;
      const double settling = std::min(linear, quiet);
      if (settling < worst.settling_N_per_m) worst = {sampled, way, settling, quiet < linear};
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

// Values with which the wall would settle. A device that sets the pace has its delay whatever the servo's rate, and
// steps of encoders are bounded by stiffness and damping.
std::string other(const Worst& worst, const Wall& wall, const DeviceLimits& device) {
  std::string words;
  if (device.sets_pace || worst.by_encoders) return words;
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

// What the contact will do, and why.
std::string reason(const RigSettings& settings, const Worst& worst, const Device& device) {
  if (!isStable(worst.loop, wallOf(settings, worst.way, roundingGain(device)))) return "so the contact will shake";
  if (!worst.by_encoders) return "so the contact may swing for long";
  const double resolution_m = device.limits().position_resolution_m;
  return fmt::format(
      "so the contact may swing on, as a step of its encoders, {:.2g} um, makes the force jump by {:.2g} N and "
      "friction quiets {:.2g} N",
      1e6 * resolution_m, forceOfAStep(worst.loop, wallOf(settings, worst.way), resolution_m), quietJump(worst.loop));
}

std::string stiffnessWarning(const RigSettings& settings, const Worst& worst, const Device& device) {
  const double factor = worst.way.factor;
  const std::string effects =
      factor == 1 ? std::string() : fmt::format(", which the effects make up to {:.3g} times as stiff", factor);
  const std::string damping = worst.way.damping_Ns_per_m < settings.parameters.damping_Ns_per_m
                                  ? std::string("along the surface, where effects hold it without damping,")
                                  : fmt::format("with a damping of {:g} N s/m", worst.way.damping_Ns_per_m);
  return fmt::format(
      "a stiffness of {:g} N/m{} is more than this device can render {}, {}: {} it settles up to {:g} N/m; give at "
      "most that{}",
      settings.parameters.stiffness_N_per_m, effects, conditionWords(worst.loop), reason(settings, worst, device),
      damping, twoDigits(worst.settling_N_per_m, std::floor),
      other(worst, wallOf(settings, worst.way, roundingGain(device)), device.limits()));
}

// The largest damping with which some wall settles in every hand [N s/m].
double mostDamping(const LoopParameters& parameters, const Device& device) {
  const double gain = roundingGain(device), resolution_m = device.limits().position_resolution_m;
  double most = kMostDamping_Ns_per_m;
  for (const HandParameters& hand : device.hands()) {
    const SampledLoop loop = sampledLoop(parameters, device, hand);
    const auto settles = [&](double damping) {
      return isDampedQuietly(loop, damping, resolution_m) &&
             settlesSoon(loop, {kSoftest_N_per_m * gain, damping * gain});
    };
    double settled = 0, beyond = std::min(most, dampingBound(loop, kSoftest_N_per_m));
    constexpr int kHalvings = 16;
    for (int i = 0; i < kHalvings; ++i) {
      const double middle = 0.5 * (settled + beyond);
      (settles(middle) ? settled : beyond) = middle;
    }
    most = std::min(most, settled);
  }
  return most;
}

// No wall settles with this damping. What is named ends every warning.
std::string dampingWarning(const RigSettings& settings, const LoopParameters& loop, const Worst& worst,
                           const Device& device) {
  RigSettings safe = settings;
  safe.parameters.damping_Ns_per_m = twoDigits(mostDamping(loop, device), std::floor);
  const double stiffness = twoDigits(worstOf(safe, loop, device).settling_N_per_m, std::floor);
  const std::string softer = stiffness < settings.parameters.stiffness_N_per_m
                                 ? fmt::format(" with a stiffness of at most {:g} N/m", stiffness)
                                 : std::string();
  return fmt::format(
      "a damping of {:g} N s/m is more than this device can render {}, so the contact will shake at any stiffness; "
      "give at most {:g} N s/m{}{}",
      settings.parameters.damping_Ns_per_m, conditionWords(worst.loop), safe.parameters.damping_Ns_per_m, softer,
      other(worst, wallOf(settings, worst.way, roundingGain(device)), device.limits()));
}

// In one of the hands: whether it swings on, or for long.
bool shakes(const RigSettings& settings, const LoopParameters& loop, const Device& device) {
  return !std::ranges::all_of(device.hands(), [&](const HandParameters& hand) {
    const SampledLoop sampled = sampledLoop(loop, device, hand);
    return std::ranges::all_of(ways(settings), [&](const Way& way) {
      return isQuiet(sampled, wallOf(settings, way), device.limits().position_resolution_m) &&
             settlesSoon(sampled, wallOf(settings, way, roundingGain(device)));
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
  const double most = device.hands().empty() ? asked : mostDamping(loop, device);
  return most < asked ? twoDigits(most, std::floor) : asked;
}

std::vector<std::string> boundWarnings(const RigSettings& settings, const LoopParameters& loop, const Device& device) {
  if (device.hands().empty() || loop.passivity.control) return {};
  if (!algorithmEntry(settings.algorithm).traits.shows_surface || !shakes(settings, loop, device)) return {};
  const Worst worst = worstOf(settings, loop, device);
  if (worst.settling_N_per_m > 0) return {stiffnessWarning(settings, worst, device)};
  return {dampingWarning(settings, loop, worst, device)};
}

}  // namespace palpate
