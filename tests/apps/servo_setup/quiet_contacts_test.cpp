// SPDX-License-Identifier: Apache-2.0
// What is said before a run holds in the run: where nothing is warned about the contact is never unstable, keeps its
// force, and does not swing along the surface, up to the stiffness that the program itself names. Above the exact limit
// there is always a warning.
#include <algorithm>
#include <array>

#include <fmt/format.h>
#include <gtest/gtest.h>

#include "apps/servo_setup/contact_bounds.hpp"
#include "servo/devices/simulated_device.hpp"
#include "servo/devices/typical_hands.hpp"
#include "servo/loop/contact_stability.hpp"
#include "servo/safety/faults.hpp"
#include "servo/stability/sampled_loop.hpp"
#include "tests/servo/loop/wanted_path.hpp"
#include "tests/servo/support/algorithm_setups.hpp"
#include "tests/servo/support/seeded.hpp"
#include "tests/support/long_run.hpp"

namespace palpate {
namespace quiet_contacts_test {

const Vec3 kCentre = Vec3::Constant(31.3e-3);
constexpr double kRadius_m = 20e-3, kVoxel_m = 1e-3;

// Two materials beside each other under one surface: beyond the middle the density rises four times as fast.
const AnalyticVolume& ground(bool round) {
  const auto halves = [](double inward_m, const Vec3& p) { return inward_m * (p.x() > kCentre.x() ? 4 : 1); };
  static const AnalyticVolume kBall =
      millimetreVolume([halves](const Vec3& p) { return halves(kRadius_m - (p - kCentre).norm(), p); });
  static const AnalyticVolume kPlane =
      millimetreVolume([halves](const Vec3& p) { return halves(kCentre.z() + kRadius_m - p.z(), p); });
  return round ? kBall : kPlane;
}

struct Trial {
  SimulatedDeviceParameters device;
  LoopParameters loop;
  RigSettings settings;
  double press_m = 1e-3;     // how deep the hand wants to be
  double from_m = 0;         // where, from the border of the materials
  double sweep_m_per_s = 0;  // along the surface, once it is there
  bool round = true;
  double seconds = 3;

  [[nodiscard]] SampledLoop sampled() const {
    return {.hand = device.dynamics, .rate_hz = loop.rate_hz, .delay_ticks = device.delay_ticks};
  }
};

// A hand of the table, or one between two of them; any device that a hand holds. `friction`: only then the device has
// some of its own, since it makes the loop quieter than the linear one.
Trial anyTrial(Seeded& random) {
  Trial t;
  const TypicalHand& a = kTypicalHands[static_cast<std::size_t>(random.pick(3))];
  const TypicalHand& b = kTypicalHands[static_cast<std::size_t>(random.pick(3))];
  const double share = random.pick(2) == 0 ? 0 : random.between(0, 1);
  const auto between = [share](double one, double other) { return one * std::pow(other / one, share); };
  t.device.hand = Hand::kSpring;
  t.device.dynamics = {.hand_mass_kg = between(a.mass_kg, b.mass_kg),
                       .hand_damping_Ns_per_m = between(a.damping_Ns_per_m, b.damping_Ns_per_m),
                       .hand_stiffness_N_per_m = between(a.stiffness_N_per_m, b.stiffness_N_per_m),
                       .device_mass_kg = random.logBetween(0.02, 0.5),
                       .device_damping_Ns_per_m = random.logBetween(0.01, 3),
                       .device_friction_N = random.pick(3) == 0 ? random.logBetween(0.005, 0.2) : 0};
  t.device.delay_ticks = random.pick(2) == 0 ? 0 : random.pick(9);
  t.device.encoder_resolution_m = random.pick(2) == 0 ? 0 : random.logBetween(1e-6, 50e-6);
  t.loop.rate_hz = random.logBetween(500, 4000);
  t.loop.safety.force_limit_N = 1e3;  // the loop of the bounds knows none
  t.settings.parameters.isovalue = 0;
  t.settings.parameters.rate_hz = t.loop.rate_hz;
  t.settings.parameters.plane_renewal_ticks = random.pick(2) == 0 ? 5 : 1 + random.pick(20);
  // Mostly as people choose it; now and then all that is not warned of.
  const double most = usefulDamping(t.sampled());
  const double largest = random.pick(4) == 0 ? most : std::min(0.5 * most, 10.0);
  t.settings.parameters.damping_Ns_per_m = random.pick(3) == 0 ? 0 : random.between(0, largest);
  if (random.pick(4) == 0) t.settings.effects.friction = {0.4, 0.3, 0};
  if (random.pick(4) == 0) {
    t.settings.effects.texture = TextureKind::kProcedural;
    t.settings.effects.texture_amplitude_m = random.logBetween(0.01e-3, 0.1e-3);
    t.settings.effects.texture_wavelength_m = random.between(1e-3, 3e-3);
  }
  if (random.pick(4) == 0) t.settings.effects.stiffness_by_density = {{2.5e-3, 0.5}, {10e-3, random.between(1, 3)}};
  if (random.pick(4) == 0) t.settings.effects.force_shading = true;
  if (random.pick(4) == 0) t.settings.effects.recovery_s = 0.02;
  t.press_m = random.logBetween(0.3e-3, 10e-3);
  t.from_m = random.between(-2e-3, 2e-3);
  t.sweep_m_per_s = random.pick(2) == 0 ? 0 : random.between(0.002, 0.02);
  t.round = random.pick(2) == 0;
  if (t.sweep_m_per_s == 0) t.seconds = 10;  // every hand, with 2 m / b below 1.1 s, has come to rest by then
  return t;
}

struct Outcome {
  ContactVerdict verdict = ContactVerdict::kNoContact;
  double swing_m = 0, swing_hz = 0;
  double aside_m = 0;  // swings along the surface of a hand that stays where it is
  bool lost_force = false;
};

// Of the last half second: how far the tool went to and fro along an axis across the normal, less how far it got.
double swingAside(const std::vector<TickRecord>& records, double rate_hz) {
  double most_m = 0;
  const std::size_t first = records.size() - static_cast<std::size_t>(0.5 * rate_hz);
  for (const int axis : {0, 1}) {
    double low_m = records[first].hip_W[axis], high_m = low_m;
    for (std::size_t i = first; i < records.size(); ++i) {
      low_m = std::min(low_m, records[i].hip_W[axis]);
      high_m = std::max(high_m, records[i].hip_W[axis]);
    }
    most_m = std::max(most_m, high_m - low_m - std::abs(records.back().hip_W[axis] - records[first].hip_W[axis]));
  }
  return most_m;
}

Outcome outcomeOf(const Trial& t) {
  const AnalyticVolume& volume = ground(t.round);
  AlgorithmSetup setup = setupFor(t.settings.algorithm, t.settings.parameters, volume, 4e-3);
  setup.effects =
      makeContactEffects(t.settings.effects, t.settings.parameters.stiffness_N_per_m, t.settings.parameters.rate_hz);
  const std::unique_ptr<Algorithm> algorithm = makeAlgorithm(t.settings.algorithm, std::move(setup));
  const WantedPath path([&t](double t_s) {
    const double height_m = 1e-3 - (1e-3 + t.press_m) * std::clamp(t_s / 0.3, 0.0, 1.0);
    const double aside_m = t.from_m + t.sweep_m_per_s * std::max(0.0, t_s - 0.3);
    const double angle = t.round ? aside_m / kRadius_m : 0;
    return Vec3(kCentre + (kRadius_m + height_m) * Vec3(std::sin(angle), 0, std::cos(angle)) +
                Vec3(t.round ? 0 : aside_m, 0, 0));
  });
  SimulatedDevice device(t.device, path, t.loop.rate_hz);
  WindowStorage storage(std::size_t{20} * 20 * 20);
  WindowExchange windows(storage);
  ToolPoseMailbox tool;
  LoopParameters loop = t.loop;
  loop.ticks = std::llround(t.seconds * loop.rate_hz);
  loop.instability.doubtful = mayShake(t.settings, loop, device);
  ServoLoop servo(loop, *algorithm, device, windows, tool);
  Vec3 published_W = Vec3::Constant(1e3);
  const LoopResult result = servo.runSimulated([&](std::int64_t, std::int64_t now_ns) {
    const ToolPose& pose = tool.latest();
    const Vec3 focus_W = pose.at_surface ? pose.surface_W : pose.position_W;
    if ((focus_W - published_W).cwiseAbs().maxCoeff() > 3 * kVoxel_m) {
      const Vec3i count = Vec3i::Constant(20);
      volume.fill(windows.back(), windows.backSamples(), volume.firstAround(focus_W, count), count);
      windows.back().stamp_ns = now_ns;
      windows.publish();
      published_W = focus_W;
    }
    windows.confirm(now_ns);
  });
  const ContactStability judged = assessContact(
      result.records,
      {.resolution_m = t.device.encoder_resolution_m, .delay_ticks = t.device.delay_ticks, .path = &path});
  Outcome out{judged.verdict, judged.swing_m, judged.swing_hz, 0, false};
  if (t.sweep_m_per_s == 0) out.aside_m = swingAside(result.records, loop.rate_hz);
  for (const TickRecord& r : result.records) out.lost_force = out.lost_force || has(r.faults, ServoFault::kUnstable);
  return out;
}

// The stiffness that the program names, where the settings ask for far too much.
double named(const Trial& t) {
  const WantedPath still([](double) { return Vec3(Vec3::Zero()); });
  const SimulatedDevice device(t.device, still, t.loop.rate_hz);
  return renderableStiffness(t.settings, t.loop, device);
}

bool isWarned(const Trial& t) {
  const WantedPath still([](double) { return Vec3(Vec3::Zero()); });
  return !boundWarnings(t.settings, t.loop, SimulatedDevice(t.device, still, t.loop.rate_hz)).empty();
}

TEST(QuietContacts, WithoutAWarningNoneIsUnstableOrLosesItsForce) {
  Seeded random(91);
  const int trials = isLongRun() ? 2000 : 500;
  int ran = 0;
  for (int i = 0; i < trials; ++i) {
    Trial t = anyTrial(random);
    t.settings.parameters.stiffness_N_per_m = 1e9;
    const double most = named(t);
    if (!(most > 5)) continue;  // nothing that a hand feels
    t.settings.parameters.stiffness_N_per_m = (i % 2 == 0 ? 1 : random.between(0.3, 1)) * std::min(most, 2e4);
    ASSERT_FALSE(isWarned(t)) << i;
    ++ran;
    const Outcome out = outcomeOf(t);
    // Rounding alone keeps up swings of two steps of the encoders.
    const bool is_still = out.aside_m < 3 * t.device.encoder_resolution_m + 5e-6;
    EXPECT_TRUE(out.verdict != ContactVerdict::kUnstable && !out.lost_force && is_still) << fmt::format(
        "{}: K {:.0f} of {:.0f} N/m, B {:.2f}, d {}, {:.0f} Hz, m {:.3f}, b {:.2f}, k {:.0f}, f {:.3f} N, D {:.1f} um, "
        "n {}, {}, press {:.1f} mm, sweep {:.3f}, {}: {:.1f} um at {:.0f} Hz, aside {:.1f} um, force {}",
        i, t.settings.parameters.stiffness_N_per_m, stiffnessBound(t.sampled(), t.settings.parameters.damping_Ns_per_m),
        t.settings.parameters.damping_Ns_per_m, t.device.delay_ticks, t.loop.rate_hz,
        t.device.dynamics.hand_mass_kg + t.device.dynamics.device_mass_kg,
        t.device.dynamics.hand_damping_Ns_per_m + t.device.dynamics.device_damping_Ns_per_m,
        t.device.dynamics.hand_stiffness_N_per_m, t.device.dynamics.device_friction_N,
        1e6 * t.device.encoder_resolution_m, t.settings.parameters.plane_renewal_ticks,
        contactEffectNames(t.settings.effects), 1e3 * t.press_m, t.sweep_m_per_s, t.round ? "ball" : "plane",
        1e6 * out.swing_m, out.swing_hz, 1e6 * out.aside_m, out.lost_force ? "lost" : "kept");
  }
  EXPECT_GT(ran, trials * 3 / 4);
}

TEST(QuietContacts, AboveTheExactLimitThereIsAlwaysAWarning) {
  Seeded random(92);
  for (int i = 0; i < 500; ++i) {
    Trial t = anyTrial(random);
    const double bound = stiffnessBound(t.sampled(), t.settings.parameters.damping_Ns_per_m);
    t.settings.parameters.stiffness_N_per_m = bound * random.logBetween(1.01, 10) / mostStiffening(t.settings.effects);
    EXPECT_TRUE(isWarned(t)) << i;
  }
}

}  // namespace quiet_contacts_test
}  // namespace palpate
