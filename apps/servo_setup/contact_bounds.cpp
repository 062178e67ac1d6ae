// SPDX-License-Identifier: Apache-2.0
#include "apps/servo_setup/contact_bounds.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include <fmt/format.h>

#include "servo/stability/sampled_loop.hpp"

namespace palpate {
namespace {

// Encoders that round make a wall up to 4 / pi stiffer, and its damping as much stronger, for swings of about a step
// (the describing function of a quantiser).
double roundingGain(double resolution_m) {
  return resolution_m > 0 ? 4 / M_PI : 1;
}

// A direction in which the contact holds the tool: by how much of the settings' stiffness, and how damped.
struct Way {
  double factor = 1;
  double damping_Ns_per_m = 0;
};

// Along the normal; along the surface too where effects hold the tool, without damping.
std::vector<Way> ways(const RigSettings& settings) {
  const double by_algorithm = algorithmEntry(settings.algorithm).traits.stiffening;
  std::vector<Way> all = {{by_algorithm * mostStiffening(settings.effects), settings.parameters.damping_Ns_per_m}};
  const double aside = by_algorithm * mostStiffeningAside(settings.effects);
  if (aside > 0) all.push_back({aside, 0});
  return all;
}

Wall wallOf(const RigSettings& settings, const Way& way, double gain = 1) {
  return {settings.parameters.stiffness_N_per_m * way.factor * gain, way.damping_Ns_per_m * gain};
}

// Swings of a few steps of the encoders know no damping, since a velocity that is rounded comes in steps, too. So they
// go on where the wall is unstable without its damping, unless dry friction quiets them (quietJump()).
// A wall that answers a step by more than kMostJumps times as much lets the tool go and hits it again whatever else is
// true, and so does a damping by more than kMostDampingJumps times: with 10, forces chattered between none and three
// times their mean (50 um, 11 N s/m), with 90 an arm bounced at 5 Hz, too slowly for the guard.
constexpr double kMostJumps = 10, kMostDampingJumps = 5;

bool isDampedQuietly(const SampledLoop& loop, double damping_Ns_per_m, double resolution_m) {
  return forceOfAStep(loop, {0, damping_Ns_per_m}, resolution_m) <= kMostDampingJumps * quietJump(loop.hand);
}

// Whether such swings die. Without the gain of rounding, which is that of swings of about a step: of 12,000 contacts
// none needed it here.
bool isQuiet(const SampledLoop& loop, const Wall& wall, double resolution_m) {
  constexpr double kRounding = 1e-9;  // of quietStiffness()
  if (!isDampedQuietly(loop, wall.damping_Ns_per_m, resolution_m)) return false;
  const double jumps = forceOfAStep(loop, wall, resolution_m) / quietJump(loop.hand);
  if (jumps > kMostJumps * (1 + kRounding)) return false;
  return jumps <= 1 + kRounding || isStable(loop, {wall.stiffness_N_per_m * (1 - kRounding), 0});
}

// The stiffness up to which they do; 0: none.
double quietStiffness(const SampledLoop& loop, double damping_Ns_per_m, double resolution_m) {
  if (!(resolution_m > 0)) return std::numeric_limits<double>::infinity();
  if (!isDampedQuietly(loop, damping_Ns_per_m, resolution_m)) return 0;
  const auto with = [&](double jumps) {
    return (jumps * quietJump(loop.hand) - forceOfAStep(loop, {0, damping_Ns_per_m}, resolution_m)) / resolution_m;
  };
  return std::min(with(kMostJumps), std::max(with(1), stiffnessBound(loop, 0)));
}

// What is asked whether it shakes.
struct Contact {
  RigSettings settings;
  LoopParameters loop;
  DeviceLimits limits;
  std::vector<HandParameters> hands;

  Contact(const RigSettings& of_settings, const LoopParameters& of_loop, const Device& device)
      : settings(of_settings), loop(of_loop), limits(device.limits()), hands(device.hands()) {}
  [[nodiscard]] SampledLoop in(const HandParameters& hand) const {
    return {.hand = hand,
            .rate_hz = loop.rate_hz,
            .delay_ticks = limits.force_delay_ticks,
            .velocity_cutoff_hz = loop.velocity.name == VelocityParameters{}.name ? loop.velocity.cutoff_hz : 0};
  }
  [[nodiscard]] bool isKnown() const {
    return !hands.empty() && algorithmEntry(settings.algorithm).traits.shows_surface;
  }
};

// In one of the hands: whether it swings on, or for long.
bool shakes(const Contact& contact) {
  const double resolution_m = contact.limits.position_resolution_m;
  return !std::ranges::all_of(contact.hands, [&](const HandParameters& hand) {
    const SampledLoop loop = contact.in(hand);
    return std::ranges::all_of(ways(contact.settings), [&](const Way& way) {
      return isQuiet(loop, wallOf(contact.settings, way), resolution_m) &&
             settlesSoon(loop, wallOf(contact.settings, way, roundingGain(resolution_m)));
    });
  });
}

// In every hand: whether no swing grows.
bool isStable(const Contact& contact) {
  const double gain = roundingGain(contact.limits.position_resolution_m);
  return std::ranges::all_of(contact.hands, [&](const HandParameters& hand) {
    return std::ranges::all_of(ways(contact.settings), [&](const Way& way) {
      return isStable(contact.in(hand), wallOf(contact.settings, way, gain));
    });
  });
}

// The hand, and the way, in which the contact may be least stiff.
struct Worst {
  SampledLoop loop;
  Way way;
  double settling_N_per_m = std::numeric_limits<double>::infinity();  // of the settings' stiffness
  bool by_encoders = false;                                           // their steps bound it, not the linear loop
};

Worst worstOf(const Contact& contact) {
  Worst worst;
  const double resolution_m = contact.limits.position_resolution_m, gain = roundingGain(resolution_m);
  for (const HandParameters& hand : contact.hands) {
    for (const Way& way : ways(contact.settings)) {
      const SampledLoop loop = contact.in(hand);
      const double linear = settlingStiffness(loop, way.damping_Ns_per_m * gain) / gain / way.factor;
      const double quiet = quietStiffness(loop, way.damping_Ns_per_m, resolution_m) / way.factor;
      const double settling = std::min(linear, quiet);
      if (settling < worst.settling_N_per_m) worst = {loop, way, settling, quiet < linear};
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

// A rate, or a delay, with which the contact would settle in every hand. A device that sets the pace has its delay
// whatever the servo's rate.
std::string other(const Contact& contact) {
  std::string words;
  if (contact.limits.sets_pace) return words;
  // Encoders whose steps a higher rate makes worse have no such rate: then none is named.
  Contact faster = contact;
  const double rate_hz = leastRate([&](double tried_hz) {
    faster.loop.rate_hz = tried_hz;
    return !shakes(faster);
  });
  if (std::isfinite(rate_hz)) words += fmt::format(", or a rate of {:g} Hz or more", twoDigits(rate_hz, std::ceil));
  Contact earlier = contact;
  while (--earlier.limits.force_delay_ticks >= 0) {
    if (shakes(earlier)) continue;
    const int ticks = earlier.limits.force_delay_ticks;
    words += fmt::format(", or a delay of at most {} tick{}", ticks, ticks == 1 ? "" : "s");
    break;
  }
  return words;
}

std::string conditionWords(const SampledLoop& loop) {
  return loop.delay_ticks > 0 ? fmt::format("at {:g} Hz and {} tick{} late", loop.rate_hz, loop.delay_ticks,
                                            loop.delay_ticks == 1 ? "" : "s")
                              : fmt::format("at {:g} Hz", loop.rate_hz);
}

std::string stepWords(const SampledLoop& loop, const Wall& wall, double resolution_m) {
  return fmt::format(
      "as a step of its encoders, {:.2g} um, makes the force jump by {:.2g} N and friction quiets {:.2g} N",
      1e6 * resolution_m, forceOfAStep(loop, wall, resolution_m), quietJump(loop.hand));
}

// What the contact will do, and why.
std::string reason(const Contact& contact, const Worst& worst) {
  const double resolution_m = contact.limits.position_resolution_m;
  if (!isStable(contact)) return "so the contact will shake";
  if (!worst.by_encoders) return "so the contact may swing for long";
  return "so the contact may swing on, " + stepWords(worst.loop, wallOf(contact.settings, worst.way), resolution_m);
}

std::string stiffnessWarning(const Contact& contact, const Worst& worst) {
  const double factor = worst.way.factor;
  const AlgorithmParameters& parameters = contact.settings.parameters;
  const std::string effects =
      factor == 1 ? std::string()
                  : fmt::format(", which effects or algorithm make up to {:.3g} times as stiff,", factor);
  const std::string damping = worst.way.damping_Ns_per_m < parameters.damping_Ns_per_m
                                  ? std::string("along the surface, where effects hold it without damping,")
                                  : fmt::format("with a damping of {:g} N s/m", worst.way.damping_Ns_per_m);
  return fmt::format(
      "a stiffness of {:g} N/m{} is more than this device can render {}, {}: {} it settles up to {:g} N/m; give at "
      "most that{}",
      parameters.stiffness_N_per_m, effects, conditionWords(worst.loop), reason(contact, worst), damping,
      twoDigits(worst.settling_N_per_m, std::floor), other(contact));
}

// The largest damping with which some wall settles in every hand [N s/m].
double mostDamping(const Contact& contact) {
  const double resolution_m = contact.limits.position_resolution_m, gain = roundingGain(resolution_m);
  double most = kMostDamping_Ns_per_m;
  for (const HandParameters& hand : contact.hands) {
    const SampledLoop loop = contact.in(hand);
    const auto settles = [&](double damping) {
      return isDampedQuietly(loop, damping, resolution_m) &&
             settlesSoon(loop, {kSoftest_N_per_m * gain, damping * gain});
    };
    double settled = 0, beyond = std::min(most, usefulDamping(loop) / gain);
    if (settles(beyond)) settled = beyond;
    constexpr int kHalvings = 16;
    for (int i = 0; i < kHalvings && settled < beyond; ++i) {
      const double middle = 0.5 * (settled + beyond);
      (settles(middle) ? settled : beyond) = middle;
    }
    most = std::min(most, settled);
  }
  return most;
}

std::string dampingReason(const Worst& worst, double damping_Ns_per_m, double resolution_m) {
  const Wall softest{kSoftest_N_per_m, damping_Ns_per_m * roundingGain(resolution_m)};
  if (!isStable(worst.loop, softest)) return "so the contact will shake at any stiffness";
  if (isDampedQuietly(worst.loop, damping_Ns_per_m, resolution_m))
    return "as it comes too late to brake, so the contact may swing at any stiffness";
  return "so the contact may swing on at any stiffness, " + stepWords(worst.loop, {0, damping_Ns_per_m}, resolution_m);
}

// No wall settles with this damping. What is named ends every warning.
std::string dampingWarning(const Contact& contact, const Worst& worst) {
  const double damping_Ns_per_m = contact.settings.parameters.damping_Ns_per_m, most = mostDamping(contact);
  Contact safe = contact;
  double stiffness = 0, safe_damping = 0;
  for (const double share : {1.0, 0.5}) {  // at the border of what brakes the walls may be soft
    safe.settings.parameters.damping_Ns_per_m = twoDigits(share * most, std::floor);
    const double settling = twoDigits(worstOf(safe).settling_N_per_m, std::floor);
    if (settling <= stiffness) continue;
    stiffness = settling;
    safe_damping = safe.settings.parameters.damping_Ns_per_m;
    if (stiffness >= contact.settings.parameters.stiffness_N_per_m) break;
  }
  const std::string softer = stiffness < contact.settings.parameters.stiffness_N_per_m
                                 ? fmt::format(" with a stiffness of at most {:g} N/m", stiffness)
                                 : std::string();
  return fmt::format("a damping of {:g} N s/m is more than this device can render {}, {}; give at most {:g} N s/m{}{}",
                     damping_Ns_per_m, conditionWords(worst.loop),
                     dampingReason(worst, damping_Ns_per_m, contact.limits.position_resolution_m), safe_damping, softer,
                     other(contact));
}

}  // namespace

bool mayShake(const RigSettings& settings, const LoopParameters& loop, const Device& device) {
  const Contact contact(settings, loop, device);
  return !contact.isKnown() || shakes(contact);
}

double renderableDamping(const RigSettings& settings, const LoopParameters& loop, const Device& device) {
  const Contact contact(settings, loop, device);
  return contact.isKnown() ? twoDigits(mostDamping(contact), std::floor) : std::numeric_limits<double>::infinity();
}

double renderableStiffness(const RigSettings& settings, const LoopParameters& loop, const Device& device) {
  const Contact contact(settings, loop, device);
  return contact.isKnown() ? worstOf(contact).settling_N_per_m : std::numeric_limits<double>::infinity();
}

double usualStiffness(const RigSettings& settings, const LoopParameters& loop, const Device& device) {
  const DeviceLimits limits = device.limits();
  const double asked = settings.parameters.stiffness_N_per_m;
  if (!limits.follows_force) return asked;
  double most = renderableStiffness(settings, loop, device);
  for (const HandParameters& hand : device.hands()) {
    // 2 f / D alone: the other term of that bound is for a wall without damping, and the sampled loop is exact.
    if (hand.device_friction_N > 0 && limits.position_resolution_m > 0)
      most = std::min(most, 2 * hand.device_friction_N / limits.position_resolution_m /
                                std::max(mostStiffening(settings.effects), mostStiffeningAside(settings.effects)));
  }
  const double wanted = limits.stiffness_limit_N_per_m > 0 ? limits.stiffness_limit_N_per_m : asked;
  if (!(most > 0)) return wanted;  // no stiffness settles with this damping: boundWarnings() says so
  return most < wanted ? twoDigits(most, std::floor) : wanted;
}

double usualDamping(const RigSettings& settings, const LoopParameters& loop, const Device& device) {
  const double asked = settings.parameters.damping_Ns_per_m;
  if (!device.limits().follows_force) return asked;
  return std::min(asked, renderableDamping(settings, loop, device));
}

std::vector<std::string> boundWarnings(const RigSettings& settings, const LoopParameters& loop, const Device& device) {
  const Contact contact(settings, loop, device);
  if (!contact.isKnown() || !shakes(contact)) return {};
  const Worst worst = worstOf(contact);
  std::string warning = worst.settling_N_per_m > 0 ? stiffnessWarning(contact, worst) : dampingWarning(contact, worst);
  if (loop.passivity.control) warning += ". The passivity controller lessens that, but not in every contact";
  return {warning};
}

}  // namespace palpate
