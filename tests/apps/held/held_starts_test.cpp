// SPDX-License-Identifier: Apache-2.0
// How a run begins and ends on an arm that a person holds, or that nobody holds: each kind of the table, in any pose of
// its reach, in free space.
#include <algorithm>
#include <cmath>
#include <functional>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "apps/devices/device_table.hpp"
#include "servo/devices/placed_device.hpp"
#include "servo/devices/polhem_device.hpp"
#include "servo/devices/typical_hands.hpp"
#include "servo/loop/servo_loop.hpp"
#include "tests/servo/support/emulated_polhem.hpp"
#include "tests/servo/support/seeded.hpp"
#include "tests/support/long_run.hpp"

namespace palpate {
namespace held_starts_test {

constexpr double kRate_hz = 1000;

// Pushes as it is told; in free space it does not.
class Push final : public Algorithm {
 public:
  void reset(const Vec3&) noexcept override {}
  void tick(const TickInput& in, TickOutput& out) noexcept override {
    out = TickOutput{};
    out.vhip_W = in.hip_W;
    out.force_W = force_W;
  }
  Vec3 force_W = Vec3::Zero();
};

struct Kind {
  std::string name;
  PolhemParameters arm;
};

// The arms of the program's own table, with amplifiers of 6 A, the stronger ones.
std::vector<Kind> arms() {
  std::vector<Kind> arms;
  for (const DeviceKind& kind : deviceKinds({})) {
    if (kind.family != "polhem-family") continue;
    arms.push_back({kind.name, polhemParametersOf(kind.values)});
    arms.back().arm.current_limit_A = 6;
  }
  return arms;
}

Vec3 deviceFrame(const Vec3& v_A) {
  return {v_A.y(), v_A.z(), v_A.x()};
}

// Where the handle is with these counts [m, in D].
Vec3 home(const PolhemParameters& p) {
  const ArmKinematics arm(p.joints, p.origin_m);
  ArmCounts counts{};
  std::copy(p.home_counts.begin(), p.home_counts.end(), counts.begin());
  return deviceFrame(arm.position(arm.angles(counts)));
}

// Any pose that the arm reaches, 5 mm from being stretched out or folded at the least, where the emulation ends.
Vec3 anyPose(const PolhemParameters& p, Seeded& random) {
  const ArmKinematics arm(p.joints, p.origin_m);
  for (;;) {
    const Vec3 at_D = random.inCube(p.joints[1].length_m + p.joints[2].length_m + p.origin_m.norm());
    const auto reaches = [&](const Vec3& aside) {
      return arm.anglesAt(Vec3(at_D.z(), at_D.x(), at_D.y()) + 5e-3 * aside).has_value();
    };
    bool is_inside = true;
    for (int axis = 0; axis < 3; ++axis)
      is_inside = is_inside && reaches(Vec3::Unit(axis)) && reaches(-Vec3::Unit(axis));
    if (is_inside) return at_D;
  }
}

// Nobody holds it: mass and friction alone. Or a typical hand rests there.
HandParameters anyHand(const PolhemParameters& p, int which) {
  HandParameters free{.hand_mass_kg = 0, .hand_damping_Ns_per_m = 0, .hand_stiffness_N_per_m = 0};
  free.device_mass_kg = p.mass_kg;
  free.device_damping_Ns_per_m = p.damping_Ns_per_m;
  if (which == 0) return free;
  return kTypicalHands[static_cast<std::size_t>(which - 1)].holding(free);
}
constexpr int kHands = 1 + static_cast<int>(kTypicalHands.size());

// Whether somebody has seen that the motors pull as they should; how they are plugged; what else the arm may be.
struct Motors {
  bool are_checked = true;
  ArmWiring wiring = {};
  std::vector<PolhemParameters> look_alikes = {};
};

// An emulated arm in a loop by the simulated clock, in a window without anything in it.
struct HeldRun {
  HeldRun(const PolhemParameters& p, const HandParameters& hand, const Path& path, bool calibrated,
          const Motors& motors = {})
      : emulated(p, hand, path, 1 / kRate_hz, calibrated), cable(emulated), storage(8), windows(storage) {
    emulated.wire(motors.wiring, p.home_counts);
    if (!calibrated) emulated.restart();
    auto arm = std::make_shared<PolhemDevice>(p,
                                              PolhemUse{.simulated_clock = true,
                                                        .rate_hz = kRate_hz,
                                                        .calibrated = calibrated,
                                                        .motors_checked = motors.are_checked,
                                                        .look_alikes = motors.look_alikes,
                                                        .answer_ms = 0},
                                              cable.opener());
    polhem = arm.get();
    device = std::make_unique<PlacedDevice>(std::move(arm), Placement{.R_WD = facingThePatient()});
    parameters.rate_hz = kRate_hz;
    parameters.record_ticks = 0;
  }

  LoopResult run(std::int64_t ticks, const std::function<void(std::int64_t)>& before_tick = {}) {
    parameters.ticks = ticks;
    ServoLoop loop(parameters, push, *device, windows, tool);
    return loop.runSimulated([&](std::int64_t tick, std::int64_t now_ns) {
      if (tick == 0) publish(now_ns);
      windows.confirm(now_ns);
      if (before_tick) before_tick(tick);
    });
  }
  void publish(std::int64_t now_ns) {
    SampleWindow& window = windows.back();
    window.size = Vec3i::Constant(2);
    std::fill_n(windows.backSamples(), 8, Sample{});
    window.stamp_ns = now_ns;
    windows.publish();
  }

  EmulatedPolhem emulated;
  EmulatedCable cable;
  PolhemDevice* polhem = nullptr;
  std::unique_ptr<PlacedDevice> device;
  WindowStorage storage;
  WindowExchange windows;
  ToolPoseMailbox tool;
  Push push;
  LoopParameters parameters;
};

SampledPath restingAt(const Vec3& at_D) {
  return {{0}, {at_D}, SampledPath::Interpolation::kLinear};
}

// The largest force that acted from this tick on [N].
double largestForce(const EmulatedPolhem& arm, std::size_t from = 0) {
  double largest_N = 0;
  for (std::size_t i = from; i < arm.forces_D().size(); ++i) largest_N = std::max(largest_N, arm.forces_D()[i].norm());
  return largest_N;
}

constexpr double kMostAtTheStart_N = 0.5, kMostWay_m = 0.02;

void expectNoBlow(const PolhemParameters& p, const Vec3& at_D, int hand) {
  const SampledPath path = restingAt(at_D);
  HeldRun held(p, anyHand(p, hand), path, true);
  ASSERT_TRUE(held.run(1000).released);
  EXPECT_LE(largestForce(held.emulated), kMostAtTheStart_N);
  EXPECT_LE((held.emulated.hand().position_W - at_D).norm(), kMostWay_m);
}

TEST(HeldStarts, AtHomeNoArmIsPushed) {
  for (const Kind& kind : arms()) {
    for (int hand = 0; hand < kHands; ++hand) {
      SCOPED_TRACE(kind.name + ", hand " + std::to_string(hand));
      EXPECT_GT(home(kind.arm).norm(), kind.arm.workspace_radius_m) << "outside of its workspace";
      expectNoBlow(kind.arm, home(kind.arm), hand);
    }
  }
}

TEST(HeldStarts, InNoPoseAnArmIsPushed) {
  Seeded random(1);
  int outside = 0;
  for (const Kind& kind : arms()) {
    for (int i = 0; i < 60; ++i) {
      const Vec3 at_D = anyPose(kind.arm, random);
      outside += at_D.norm() > kind.arm.workspace_radius_m ? 1 : 0;
      SCOPED_TRACE(kind.name + ", start " + std::to_string(i));
      expectNoBlow(kind.arm, at_D, i % kHands);
    }
  }
  EXPECT_GT(outside, 100);
}

// The handle's button, or 'palpate calibrate': from then on the arm knows that it is at home, outside of its workspace.
TEST(HeldStarts, CalibratingAtHomePushesNobody) {
  for (const Kind& kind : arms()) {
    for (int hand = 0; hand < kHands; ++hand) {
      SCOPED_TRACE(kind.name + ", hand " + std::to_string(hand));
      const Vec3 at_D = home(kind.arm);
      const SampledPath path = restingAt(at_D);
      HeldRun held(kind.arm, anyHand(kind.arm, hand), path, false);
      ASSERT_EQ(held.polhem->forceOff(), ForceOff::kUncalibrated);
      ASSERT_TRUE(held.run(1500,
                           [&](std::int64_t tick) {
                             if (tick == 300) held.emulated.pressCalibration();
                           })
                      .released);
      EXPECT_EQ(held.polhem->forceOff(), ForceOff::kNone);
      EXPECT_LE(largestForce(held.emulated), kMostAtTheStart_N);
      EXPECT_LE((held.emulated.hand().position_W - at_D).norm(), kMostWay_m);
    }
  }
}

// Pulled out, switched off and on, plugged in and calibrated at home again.
TEST(HeldStarts, ComingBackPushesNobody) {
  for (const Kind& kind : arms()) {
    for (int hand = 0; hand < kHands; ++hand) {
      SCOPED_TRACE(kind.name + ", hand " + std::to_string(hand));
      const Vec3 at_D = home(kind.arm);
      const SampledPath path = restingAt(at_D);
      HeldRun held(kind.arm, anyHand(kind.arm, hand), path, true);
      ASSERT_TRUE(held.run(2500,
                           [&](std::int64_t tick) {
                             if (tick == 300) held.cable.unplugged = true;
                             if (tick == 350) held.emulated.restart();
                             if (tick == 600) held.cable.unplugged = false;
                             if (tick == 900) held.emulated.pressCalibration();
                           })
                      .released);
      EXPECT_EQ(held.polhem->forceOff(), ForceOff::kNone);
      EXPECT_LE(largestForce(held.emulated), kMostAtTheStart_N);
      EXPECT_LE((held.emulated.hand().position_W - at_D).norm(), kMostWay_m);
    }
  }
}

// From the middle of the workspace for 1.2 s to nearly home by 1.8 s, in a straight line of the joints' angles: what
// lies between two places in space may be out of reach.
SampledPath outOfTheWorkspace(const PolhemParameters& p) {
  const ArmKinematics arm(p.joints, p.origin_m);
  ArmCounts counts{};
  std::copy(p.home_counts.begin(), p.home_counts.end(), counts.begin());
  const Vec3 from = arm.anglesAt(Vec3::Zero()).value(), to = arm.angles(counts);
  std::vector<double> times_s = {0};
  std::vector<Vec3> points_D = {Vec3::Zero()};
  for (int i = 0; i <= 20; ++i) {
    times_s.push_back(1.2 + 0.03 * i);
    points_D.push_back(deviceFrame(arm.position(from + 0.045 * i * (to - from))));
  }
  return {std::move(times_s), std::move(points_D), SampledPath::Interpolation::kLinear};
}

// With its switch pressed a hand goes out of the workspace; let go there, it is not pushed.
TEST(HeldStarts, LettingGoOfTheClutchPushesNobody) {
  for (const Kind& kind : arms()) {
    SCOPED_TRACE(kind.name);
    const SampledPath path = outOfTheWorkspace(kind.arm);
    HeldRun held(kind.arm, anyHand(kind.arm, kHands - 1), path, true);
    ASSERT_TRUE(held.run(2900, [&](std::int64_t tick) { held.emulated.press(tick >= 1150 && tick < 1900); }).released);
    EXPECT_GT(held.emulated.hand().position_W.norm(), 1.1 * kind.arm.workspace_radius_m);
    EXPECT_LE(largestForce(held.emulated), kMostAtTheStart_N);
  }
}

// Whatever the algorithm wants: within a second the force grows to it, in a straight line. Half a milliampere of each
// motor is 0.05 N at most here.
constexpr double kRounding_N = 0.05;

TEST(HeldStarts, AForceGrowsOverASecond) {
  for (const Kind& kind : arms()) {
    SCOPED_TRACE(kind.name);
    const SampledPath path = restingAt(Vec3::Zero());
    HeldRun held(kind.arm, anyHand(kind.arm, kHands - 1), path, true);
    held.push.force_W = {0, 0, 3};
    ASSERT_TRUE(held.run(1500).released);
    const std::vector<Vec3>& forces = held.emulated.forces_D();
    for (std::size_t i = 0; i < 1490; ++i) {
      const double wanted_N = 3 * std::min(1.0, (static_cast<double>(i) + 1) / 1000);
      ASSERT_NEAR(forces[i].norm(), wanted_N, kRounding_N + 0.003) << i;
    }
  }
}

// While a hand moves aside at 0.3 m/s: the force falls in a straight line over the fade time, in its own direction. For
// the currents belong to where the arm is: at the place where the run ended they would push aside by 0.03 m / 0.13 m.
TEST(HeldStarts, TheEndFadesAsAFaultDoes) {
  for (const Kind& kind : arms()) {
    SCOPED_TRACE(kind.name);
    const SampledPath path({0, 1.4, 1.7}, {Vec3::Zero(), Vec3::Zero(), Vec3(0.09, 0, 0)},
                           SampledPath::Interpolation::kLinear);
    HeldRun held(kind.arm, anyHand(kind.arm, kHands - 1), path, true);
    held.push.force_W = {0, 0, 3};  // up: y in D
    ASSERT_TRUE(held.run(1500).released);
    const std::vector<Vec3>& forces = held.emulated.forces_D();
    ASSERT_EQ(forces.size(), 1499U + 99);
    EXPECT_NEAR(forces[1498].norm(), 3, kRounding_N);
    for (std::size_t i = 1; i <= 99; ++i) {
      const Vec3 wanted_D(0, 3 * (1 - static_cast<double>(i) / 100), 0);
      // The pose is of the tick before: 0.3 mm of a lever of 0.1 m.
      ASSERT_LT((forces[1498 + i] - wanted_D).norm(), kRounding_N + 0.003 * 3) << i;
    }
  }
}

// ---- anything, at any time ----

// What an arm's force may be, counted apart from the servo's own code: nothing while the arm is off; else the kind's
// limit, times what of a second has passed since it began or began anew, and no more than a slew from the force before.
class Allowed {
 public:
  Allowed(double limit_N, double slew_N_per_s) : limit_N_(limit_N), slew_N_(slew_N_per_s / kRate_hz) {}
  // After a tick of the servo: whether its device exerted forces at that tick.
  void tick(bool exerts) { on_ticks_ = exerts ? on_ticks_ + 1 : 0; }
  [[nodiscard]] double most_N() const { return limit_N_ * std::min(1.0, on_ticks_ / kRate_hz); }
  [[nodiscard]] double slew_N() const { return slew_N_; }

 private:
  double limit_N_, slew_N_, on_ticks_ = 0;
};

// Checked or not, plugged as they should be or anyhow: before somebody has checked them, or since. The arm may be one
// of the others of the table, or it is the only one with its numbers.
Motors anyMotors(const std::vector<Kind>& kinds, const Kind& kind, Seeded& random) {
  Motors motors;
  motors.are_checked = random.pick(2) == 0;
  const bool is_alone = random.pick(2) == 0;
  for (const Kind& other : kinds)
    if (!is_alone && other.name != kind.name) motors.look_alikes.push_back(other.arm);
  if (random.pick(2) == 0) return motors;
  for (int k = 2; k > 0; --k)
    std::swap(motors.wiring.motor[static_cast<std::size_t>(k)],
              motors.wiring.motor[static_cast<std::size_t>(random.pick(k + 1))]);
  for (int& sign : motors.wiring.sign) sign = random.pick(2) == 0 ? 1 : -1;
  return motors;
}

// Whether each motor drives its own joint, the right way.
bool isRight(const ArmWiring& wiring) {
  return wiring.motor == ArmWiring{}.motor && wiring.sign == ArmWiring{}.sign;
}

// Starts in any pose, held or free, in free space or with an algorithm that wants more than the arm can; the button,
// the switch, the cable, and joints that slip by up to 20 mm at any time. A slip that is small, or met while the hand
// moves fast, passes as motion; the force is bounded all the same. So it is with motors that nobody has checked,
// however they are plugged: then it is 1 N at most.
TEST(HeldStarts, NoForceIsAboveWhatIsAllowed) {
  const int cases = isLongRun() ? 10'000 : 1500;
  const std::vector<Kind> kinds = arms();
  int slips = 0, uncalibrated = 0, acted_wrongly = 0;
  double largest_N = 0, largest_unchecked_N = 0;
  for (int i = 0; i < cases; ++i) {
    SCOPED_TRACE(i);
    Seeded random(static_cast<unsigned>(i));
    const Kind& kind = kinds[static_cast<std::size_t>(random.pick(static_cast<int>(kinds.size())))];
    const Motors motors = anyMotors(kinds, kind, random);
    const bool is_right = isRight(motors.wiring);
    const bool is_pushed = random.pick(2) == 0;
    // An arm that is pushed is in a stiff hand near the middle, or the emulated one would leave its reach.
    const Vec3 at_D = is_pushed ? Vec3(random.inCube(0.02)) : anyPose(kind.arm, random);
    const SampledPath path = restingAt(at_D);
    HeldRun held(kind.arm, anyHand(kind.arm, is_pushed ? kHands - 1 : random.pick(kHands)), path, random.pick(3) != 0,
                 motors);
    const Vec3 push_W = is_pushed ? Vec3(random.logBetween(0.1, 50) * random.direction()) : Vec3(Vec3::Zero());
    held.push.force_W = push_W;
    // Mostly the force has not grown to the whole in the end.
    const int ticks = 150 + random.pick(250) + (random.pick(8) == 0 ? 1000 : 0);
    const int press_at = random.pick(2 * ticks), switch_at = random.pick(2 * ticks), pull_at = random.pick(4 * ticks);
    const int slip_at = random.pick(2 * ticks), slip_counts = random.pick(3000) - 1500;
    const double limit_N =
        motors.are_checked ? kind.arm.force_limit_N : std::min(kind.arm.force_limit_N, kUncheckedForce_N);
    Allowed allowed(limit_N, SafetyParameters{}.slew_limit_N_per_s);
    std::vector<double> most_N;  // of the force that each tick of the servo gives
    held.parameters.record_ticks = -1;
    const LoopResult result = held.run(ticks, [&](std::int64_t tick) {
      if (tick > 0) {
        const ForceOff off = held.device->forceOff();
        allowed.tick(off == ForceOff::kNone || off == ForceOff::kClutched);
        most_N.push_back(allowed.most_N());
      }
      if (tick == press_at) held.emulated.pressCalibration();
      if (tick >= switch_at && tick < switch_at + 40) held.emulated.press(true);
      if (tick == switch_at + 40) held.emulated.press(false);
      if (tick == pull_at) held.cable.unplugged = true;
      if (tick == pull_at + 5) held.emulated.restart();
      if (tick == pull_at + 20) held.cable.unplugged = false;
      if (tick == slip_at) held.emulated.slip(static_cast<std::size_t>(random.pick(3)), slip_counts);
      if (random.pick(30) == 0) held.push.force_W = random.between(-1, 1) * push_W;
    });
    ASSERT_TRUE(result.released);
    slips += slip_at < ticks ? 1 : 0;
    uncalibrated += held.polhem->forceOff() == ForceOff::kUncalibrated ? 1 : 0;
    Vec3 before_W = Vec3::Zero();
    for (std::size_t k = 0; k < most_N.size(); ++k) {
      const Vec3 force_W = asVec3(result.records[k].force_W);
      ASSERT_LE(force_W.norm(), most_N[k] * (1 + 1e-9)) << k;
      if (force_W.norm() > 0) {
        ASSERT_LE((force_W - before_W).norm(), allowed.slew_N() * (1 + 1e-9)) << k;
      }
      before_W = force_W;
      largest_N = std::max(largest_N, force_W.norm());
      // What acts on the hand is that, unless the arm is not where the servo thinks: after a slip that has passed as
      // motion, and after its button, here mostly away from home.
      if (slip_at < ticks || press_at < ticks) continue;
      if (pull_at < ticks) continue;  // meanwhile the emulated arm has no ticks
      const double acts_N = held.emulated.forces_D()[k].norm();
      if (is_right) {
        ASSERT_LE(acts_N, is_pushed ? most_N[k] + kRounding_N : kMostAtTheStart_N) << k;
      } else if (!motors.are_checked) {
        // It may be more than the servo wants, and in another direction, but not more than that.
        ASSERT_LE(acts_N, kUncheckedForce_N + kRounding_N) << k;
        largest_unchecked_N = std::max(largest_unchecked_N, acts_N);
        acted_wrongly += acts_N > 0 ? 1 : 0;
      }
      if (most_N[k] == 0) {
        ASSERT_EQ(acts_N, 0) << k;
      }
    }
  }
  EXPECT_GT(slips, cases / 4);
  EXPECT_GT(uncalibrated, cases / 10);
  EXPECT_GT(acted_wrongly, cases / 10);
  EXPECT_GT(largest_N, 1);
  EXPECT_GT(largest_unchecked_N, 0.5);
}

}  // namespace held_starts_test
}  // namespace palpate
