// SPDX-License-Identifier: Apache-2.0
// Motors of emulated arms with leads and plugs swapped at random, dead motors and encoders, and arms that are named as
// another kind: the check finds each, and without it no force is more than 1 N at the handle, its own pushes included.
#include "servo/devices/motor_check.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "apps/devices/device_table.hpp"
#include "apps/devices/hand_way.hpp"
#include "servo/devices/polhem_device.hpp"
#include "servo/devices/typical_hands.hpp"
#include "tests/servo/support/emulated_polhem.hpp"
#include "tests/servo/support/seeded.hpp"
#include "tests/support/long_run.hpp"

namespace palpate {
namespace motor_check_test {

using Verdict = MotorFinding::Verdict;

std::vector<DeviceKind> arms() {
  std::vector<DeviceKind> arms;
  for (const DeviceKind& kind : deviceKinds({}))
    if (kind.family == "polhem-family") arms.push_back(kind);
  return arms;
}
PolhemParameters armOf(const DeviceKind& kind) {
  PolhemParameters p = polhemParametersOf(kind.values);
  p.report_bytes = 14;
  p.current_limit_A = 3;
  return p;
}

// The other kinds that an arm may be.
std::vector<PolhemParameters> lookAlikesOf(const DeviceKind& named) {
  std::vector<PolhemParameters> others;
  for (const DeviceKind& kind : arms())
    if (kind.name != named.name) others.push_back(armOf(kind));
  return others;
}

// An arm at the other end of its cable, named as another kind, or as itself.
struct Bench {
  Bench(const PolhemParameters& arm, const PolhemParameters& named, const ArmWiring& wiring, const Path& path,
        const HandParameters& hand, bool checked = false, std::vector<PolhemParameters> others = {})
      : emulated(arm, hand, path, 1e-3),
        cable((emulated.wire(wiring, named.home_counts), emulated)),
        device(named,
               {.simulated_clock = true,
                .calibrated = true,
                .motors_checked = checked,
                .look_alikes = std::move(others),
                .answer_ms = 0},
               cable.opener()) {}

  Vec3 tick() {
    Vec3 at = Vec3::Zero();
    device.elapse(1);
    static_cast<void>(device.read(at));
    time_s += 1e-3;
    return at;
  }
  // Until the check is through.
  MotorCheck check() {
    MotorCheck check(*device.arm());
    do tick();
    while (check.step(time_s));
    return check;
  }

  EmulatedPolhem emulated;
  EmulatedCable cable;
  PolhemDevice device;
  double time_s = 0;
};

HandParameters handOf(const PolhemParameters& p, Seeded& numbers) {
  HandParameters device;
  device.device_mass_kg = p.mass_kg;
  device.device_damping_Ns_per_m = p.damping_Ns_per_m;
  // Held loosely: a light or a normal hand.
  return kTypicalHands[static_cast<std::size_t>(numbers.pick(2))].holding(device);
}

SampledPath restingAt(const Vec3& at) {
  return {{0}, {at}, SampledPath::Interpolation::kLinear};
}
bool canBeTried(const DeviceKind& kind, const Vec3& at_D) {
  const PolhemParameters p = armOf(kind);
  const SampledPath path = restingAt(at_D);
  Bench bench(p, p, {}, path, {}, false, lookAlikesOf(kind));
  bench.tick();
  return bench.device.arm()->canBeTried();
}
// Where the motors of an arm can be tried, and within the 3 mm around that a push may move it.
Vec3 nearTheMiddle(Seeded& numbers, const DeviceKind& kind) {
  while (true) {
    const Vec3 at_D = numbers.between(0, 0.04) * numbers.direction();
    bool can = canBeTried(kind, at_D);
    for (int axis = 0; axis < 3; ++axis) {
      for (const double aside_m : {-3e-3, 3e-3}) can = can && canBeTried(kind, at_D + aside_m * Vec3::Unit(axis));
    }
    if (can) return at_D;
  }
}

int cases() {
  return isLongRun() ? 3000 : 60;
}

ArmWiring anyWiring(Seeded& numbers) {
  ArmWiring wiring;
  for (int k = 2; k > 0; --k)
    std::swap(wiring.motor[static_cast<std::size_t>(k)], wiring.motor[static_cast<std::size_t>(numbers.pick(k + 1))]);
  for (int& sign : wiring.sign) sign = numbers.pick(2) == 0 ? 1 : -1;
  return wiring;
}

double largestForce_N(const EmulatedPolhem& arm) {
  double most_N = 0;
  for (const Vec3& force : arm.forces_D()) most_N = std::max(most_N, force.norm());
  return most_N;
}

// What half a milliampere of each motor is at the handle.
double rounding_N(const ArmKinematics& arm, const Vec3& angles) {
  return 5e-4 * arm.pushes(angles).colwise().norm().dot(arm.bodyTorques().cwiseAbs());
}

// As it should be: whatever arm, hand and place.
TEST(MotorCheck, PassesArmsThatAreRight) {
  Seeded numbers(1);
  for (const DeviceKind& kind : arms()) {
    const PolhemParameters p = armOf(kind);
    for (int i = 0; i < cases() / 5; ++i) {
      SCOPED_TRACE(kind.name);
      const SampledPath path = restingAt(nearTheMiddle(numbers, kind));
      // As the only kind with its numbers it is pushed harder.
      const auto others = numbers.pick(3) > 0 ? lookAlikesOf(kind) : std::vector<PolhemParameters>{};
      Bench bench(p, p, {}, path, handOf(p, numbers), false, others);
      const MotorCheck check = bench.check();
      EXPECT_TRUE(check.isRight());
      for (std::size_t k = 0; k < 3; ++k) {
        const MotorFinding& finding = check.findings()[k];
        EXPECT_EQ(finding.verdict, Verdict::kRight) << k << ": joint " << finding.joint << " " << finding.share;
      }
      EXPECT_LE(largestForce_N(bench.emulated), JointedArm::kMostTrial_N + 0.05);
    }
  }
}

// Each motor whose leads or plug are swapped is named, with what it drives instead; the others are right. A motor or an
// encoder that is dead is never right.
TEST(MotorCheck, FindsSwappedAndDeadMotors) {
  Seeded numbers(2);
  const std::vector<DeviceKind> kinds = arms();
  for (int i = 0; i < cases(); ++i) {
    const DeviceKind& kind = kinds[static_cast<std::size_t>(numbers.pick(static_cast<int>(kinds.size())))];
    const PolhemParameters p = armOf(kind);
    ArmWiring wiring = anyWiring(numbers);
    const int dead = numbers.pick(8);
    if (dead < 3) wiring.sign[static_cast<std::size_t>(dead)] = 0;
    SCOPED_TRACE(kind.name + testing::PrintToString(wiring.motor) + testing::PrintToString(wiring.sign));
    const SampledPath path = restingAt(nearTheMiddle(numbers, kind));
    Bench bench(p, p, wiring, path, handOf(p, numbers), false, lookAlikesOf(kind));
    const MotorCheck check = bench.check();
    for (std::size_t k = 0; k < 3; ++k) {
      const MotorFinding& finding = check.findings()[k];
      if (wiring.sign[k] == 0) {
        EXPECT_EQ(finding.verdict, Verdict::kDead) << k;
        continue;
      }
      const auto driven = static_cast<std::size_t>(wiring.motor[k]);
      if (driven == k) {
        EXPECT_EQ(finding.verdict, wiring.sign[k] > 0 ? Verdict::kRight : Verdict::kReversed) << finding.share;
      } else if (const Vec3 torques = ArmKinematics(p.joints, p.origin_m).bodyTorques().cwiseAbs();
                 torques[static_cast<int>(driven)] < 0.3 * torques[static_cast<int>(k)]) {
        // The current that moves a strong motor's joint hardly moves a weak one's.
        EXPECT_NE(finding.verdict, Verdict::kRight) << finding.share;
      } else {
        EXPECT_EQ(finding.verdict, Verdict::kOther) << k << " " << finding.share;
        EXPECT_EQ(finding.joint, wiring.motor[k]) << k;
      }
    }
  }
  for (int encoder = 0; encoder < 3; ++encoder) {
    const PolhemParameters p = armOf(kinds.front());
    ArmWiring wiring;
    wiring.encoder[static_cast<std::size_t>(encoder)] = -1;
    const SampledPath path = restingAt(Vec3::Zero());
    Bench bench(p, p, wiring, path, handOf(p, numbers));
    EXPECT_FALSE(bench.check().isRight()) << encoder;
  }
}

// An arm that is named as another kind: its motors are too strong or too weak, or it says that it is not in the middle,
// or a hand that moves it 60 mm to the right, up and to the user is told to have gone another way, or as far as
// another.
TEST(MotorCheck, FindsArmsThatAreNamedAsAnother) {
  Seeded numbers(3);
  for (const DeviceKind& kind : arms()) {
    for (const DeviceKind& named : arms()) {
      SCOPED_TRACE(kind.name + " named " + named.name);
      const PolhemParameters p = armOf(kind);
      const HandParameters hand = handOf(p, numbers);
      const SampledPath still = restingAt(Vec3::Zero());
      Bench bench(p, armOf(named), {}, still, hand, false, lookAlikesOf(named));
      bool is_found = !bench.check().isRight();
      EXPECT_LE(largestForce_N(bench.emulated), kUncheckedForce_N);
      for (int axis = 0; axis < 3; ++axis) {
        const SampledPath path({0, 0.5, 1}, {Vec3(0, 0, 0), Vec3(0, 0, 0), Vec3(kAsked_m * Vec3::Unit(axis))},
                               SampledPath::Interpolation::kLinear);
        Bench moved(p, armOf(named), {}, path, hand);
        HandMove move;
        std::optional<Vec3> way;
        while (!way && moved.time_s < 3) way = move.look(moved.tick(), moved.time_s);
        is_found = is_found || !way || !isAsked(handWay(*way), axis);
      }
      EXPECT_EQ(is_found, kind.name != named.name);
    }
  }
}

// An arm in any pose that its joints allow and in which the one that it is said to be could be tried, with plugs and
// leads swapped. With encoder a dead no pulse of motor a is answered, and the force grows as far as it may.
TEST(MotorCheck, PushesNoHarderThanANewtonAsWhicheverArm) {
  Seeded numbers(5);
  const std::vector<DeviceKind> kinds = arms();
  int tried = 0, misnamed = 0;
  double most_N = 0;
  while (tried < (isLongRun() ? 2000 : 80)) {
    const auto any = [&] { return static_cast<std::size_t>(numbers.pick(static_cast<int>(kinds.size()))); };
    const std::size_t is = any(), says = any();
    const PolhemParameters p = armOf(kinds[is]), named = armOf(kinds[says]);
    ArmWiring wiring = anyWiring(numbers);
    const bool is_dead = numbers.pick(3) > 0;
    if (is_dead) wiring.encoder[0] = -1;
    const ArmKinematics arm(p.joints, p.origin_m), said(named.joints, named.origin_m);
    const auto said_at = said.anglesAt(numbers.between(0, 0.05) * numbers.direction());
    if (!said_at) continue;
    ArmCounts counts = said.countsAt(*said_at);
    for (std::size_t k = 0; k < 3; ++k) counts[k] += p.home_counts[k] - named.home_counts[k];
    Vec3 angles = arm.angles(counts);
    if (is_dead) angles[0] = numbers.between(p.lowest_rad[0], p.highest_rad[0]);
    bool is_possible = true;
    for (std::size_t k = 0; k < 3; ++k) {
      const double angle = angles[static_cast<int>(k)];
      is_possible = is_possible && angle >= p.lowest_rad[k] && angle <= p.highest_rad[k];
    }
    const Vec3 at_A = arm.position(angles);
    const auto back = arm.anglesAt(at_A);  // the emulated arm has its elbow turned away from the user
    if (!is_possible || !back || (*back - angles).norm() > 1e-6) continue;
    const SampledPath path = restingAt(Vec3(at_A.y(), at_A.z(), at_A.x()));
    Bench bench(p, named, wiring, path, handOf(p, numbers), false, lookAlikesOf(kinds[says]));
    bench.tick();
    if (!bench.device.arm()->canBeTried()) continue;
    SCOPED_TRACE(kinds[is].name + " named " + kinds[says].name);
    ++tried;
    misnamed += is != says ? 1 : 0;
    static_cast<void>(bench.check());
    const double largest_N = largestForce_N(bench.emulated);
    ASSERT_LE(largest_N, kUncheckedForce_N + 1.1 * rounding_N(arm, angles) + 1e-3);
    most_N = std::max(most_N, largest_N);
  }
  EXPECT_GT(misnamed, tried / 4);
  EXPECT_GT(most_N, 0.8);  // they are no more careful than they must be
}

// Whatever arm it is, however its motors are plugged, and wherever the servo wants to push: 1 N at most until the
// motors are checked. What a current is rounded to may add half a milliampere of each motor.
TEST(MotorCheck, HoldsForcesBelowANewtonUntilThen) {
  Seeded numbers(4);
  const std::vector<DeviceKind> kinds = arms();
  double most_N = 0;
  for (int i = 0; i < (isLongRun() ? 10'000 : 1000); ++i) {
    const auto any = [&] { return static_cast<std::size_t>(numbers.pick(static_cast<int>(kinds.size()))); };
    const std::size_t is = any(), says = numbers.pick(2) == 0 ? is : any();
    const PolhemParameters p = armOf(kinds[is]), named = armOf(kinds[says]);
    std::vector<PolhemParameters> others;
    for (std::size_t k = 0; k < kinds.size(); ++k)
      if (k != says) others.push_back(armOf(kinds[k]));
    const ArmWiring wiring = anyWiring(numbers);
    SCOPED_TRACE(kinds[is].name + " named " + kinds[says].name);
    const ArmKinematics arm(p.joints, p.origin_m);
    Vec3 at_D = numbers.between(0, 0.1) * numbers.direction();
    while (!arm.anglesAt(Vec3(at_D.z(), at_D.x(), at_D.y()))) at_D = numbers.between(0, 0.1) * numbers.direction();
    const SampledPath path = restingAt(at_D);
    HandParameters firm;
    firm.hand_stiffness_N_per_m = 1e5;
    Bench bench(p, named, wiring, path, firm, false, others);
    const Vec3 force_D = numbers.between(0, 8) * numbers.direction();
    for (int tick = 0; tick < 5; ++tick) {
      static_cast<void>(bench.device.write(force_D));
      bench.tick();
      EXPECT_LE(bench.device.held(force_D).norm(), kUncheckedForce_N * (1 + 1e-12));
      const Vec3 now_N = bench.emulated.force_D();
      const double rounded_N = rounding_N(arm, *arm.anglesAt(Vec3(at_D.z(), at_D.x(), at_D.y())));
      ASSERT_LE(now_N.norm(), kUncheckedForce_N + 1.1 * rounded_N + 1e-3);
      most_N = std::max(most_N, now_N.norm());
    }
  }
  EXPECT_GT(most_N, 0.5);  // it is no more careful than it must be
}

// Where an arm that it may be is stretched out, a current would push without bound: there is none.
TEST(MotorCheck, ExertsNothingWhereAnArmMayBeStretchedOut) {
  PolhemParameters named, stretched;
  for (const DeviceKind& kind : arms()) {
    if (kind.name == "polhem-v1") named = armOf(kind);
    if (kind.name == "aluhaptics") stretched = armOf(kind);  // so in its home position
  }
  const ArmKinematics arm(named.joints, named.origin_m);
  const Vec3 home_A = arm.position(arm.angles({named.home_counts[0], named.home_counts[1], named.home_counts[2]}));
  const SampledPath path = restingAt(Vec3(home_A.y(), home_A.z(), home_A.x()));
  Bench bench(named, named, {}, path, {}, false, {stretched}), alone(named, named, {}, path, {}, false);
  for (const Vec3& force_D : {Vec3(1, 0, 0), Vec3(0, 1, 0), Vec3(0, 0, 0), Vec3(1, 2, 3)}) {
    for (Bench* each : {&bench, &alone}) static_cast<void>(each->device.write(force_D));
    bench.tick();
    alone.tick();
    EXPECT_EQ(bench.device.held(force_D), Vec3(0, 0, 0));
    EXPECT_EQ(bench.emulated.currents_A(), Vec3(0, 0, 0));
    EXPECT_EQ(alone.device.held(force_D).isZero(0), force_D.isZero(0));
  }
}

}  // namespace motor_check_test
}  // namespace palpate
