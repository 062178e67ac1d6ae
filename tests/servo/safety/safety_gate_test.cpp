// SPDX-License-Identifier: Apache-2.0
#include "servo/safety/safety_gate.hpp"

#include <cmath>
#include <limits>

#include <gtest/gtest.h>

#include "base/error.hpp"
#include "support/seeded.hpp"

namespace palpate {
namespace safety_gate_test {

constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();

SafetyParameters parameters() {
  return {8, 1e6, 0.01, 0.5};
}  // 10 ticks of fade at 1 kHz, no slew to speak of

// A gate before a device that takes whatever it is offered.
class TakingGate {
 public:
  TakingGate(const SafetyParameters& p, double rate_hz) : gate_(p, rate_hz) {}
  GateOutput pass(const GateInput& in) {
    const GateOutput out = gate_.pass(in);
    gate_.taken(out.force_W);
    return out;
  }
  Vec3 release(std::int64_t gap_ns = 0) {
    gate_.taken(gate_.release(gap_ns));
    return gate_.heldForce();
  }
  void beginAnew() { gate_.beginAnew(); }
  void setForceLimit(double force_limit_N) { gate_.setForceLimit(force_limit_N); }
  [[nodiscard]] const Vec3& heldForce() const { return gate_.heldForce(); }
  [[nodiscard]] std::int64_t fadeTicks() const { return gate_.fadeTicks(); }

 private:
  SafetyGate gate_;
};

GateInput healthy(const Vec3& force_W) {
  return {force_W, 0, 0};
}

TEST(SafetyGate, LetsAHealthyForceThrough) {
  TakingGate gate(parameters(), 1000);
  const GateOutput out = gate.pass(healthy({1, 2, 3}));
  EXPECT_EQ(out.force_W, Vec3(1, 2, 3));
  EXPECT_EQ(out.faults, 0u);
}

TEST(SafetyGate, CutsToTheMaximumInTheSameDirection) {
  TakingGate gate(parameters(), 1000);
  const GateOutput out = gate.pass(healthy({0, 30, 40}));
  EXPECT_TRUE(out.force_W.isApprox(Vec3(0, 4.8, 6.4), 1e-12));
  EXPECT_EQ(out.faults, bit(ServoFault::kForceLimited));
  // Finite, but its square is not.
  const GateOutput huge = gate.pass(healthy({0, 0, 1e300}));
  EXPECT_TRUE(huge.force_W.isApprox(Vec3(0, 0, 8), 1e-12));
}

TEST(SafetyGate, LimitsTheSlewUpAndDown) {
  SafetyParameters p = parameters();
  p.slew_limit_N_per_s = 500;  // 0.5 N a tick
  TakingGate gate(p, 1000);
  for (int tick = 1; tick <= 4; ++tick) {
    const GateOutput out = gate.pass(healthy({0, 0, 2}));
    EXPECT_NEAR(out.force_W.z(), 0.5 * tick, 1e-12);
    EXPECT_EQ(has(out.faults, ServoFault::kSlewLimited), tick < 4);
  }
  EXPECT_NEAR(gate.pass(healthy({0, 0, -2})).force_W.z(), 1.5, 1e-12);
}

// Every fault that takes the force away, each raised in its own way.
struct Cause {
  const char* name;
  GateInput input;
  ServoFault fault;
};

class GateFaults : public testing::TestWithParam<Cause> {};

TEST_P(GateFaults, FadeStraightToZeroWithinTheTimeAndComeBackTheSameWay) {
  TakingGate gate(parameters(), 1000);
  for (int i = 0; i < 3; ++i) EXPECT_EQ(gate.pass(healthy({0, 0, 4})).force_W.z(), 4);
  for (int tick = 1; tick <= 10; ++tick) {
    const GateOutput out = gate.pass(GetParam().input);
    EXPECT_TRUE(has(out.faults, GetParam().fault));
    // Smaller by a tenth in each tick, from the first on: the last force is never repeated.
    EXPECT_NEAR(out.force_W.z(), 4 * (1 - tick / 10.0), 1e-12);
  }
  EXPECT_TRUE(gate.pass(GetParam().input).force_W.isZero(0));
  for (int tick = 1; tick <= 12; ++tick) {
    const GateOutput out = gate.pass(healthy({2, 0, 0}));
    EXPECT_NEAR(out.force_W.x(), 2 * std::min(1.0, tick / 10.0), 1e-12);
    EXPECT_EQ(out.faults, 0u);
  }
}

constexpr std::int64_t kStale_ns = 500'000'001;
INSTANTIATE_TEST_SUITE_P(
    All, GateFaults,
    testing::Values(Cause{"NoWindow", {{0, 0, 4}, 0, bit(ServoFault::kNoWindow)}, ServoFault::kNoWindow},
                    Cause{"Stale", {{0, 0, 4}, kStale_ns, 0}, ServoFault::kStaleWindow},
                    Cause{"Beyond", {{0, 0, 4}, 0, bit(ServoFault::kBeyondWindow)}, ServoFault::kBeyondWindow},
                    Cause{"NaN", {{0, kNaN, 4}, 0, 0}, ServoFault::kNonFiniteForce},
                    Cause{"Infinite", {{0, 0, INFINITY}, 0, 0}, ServoFault::kNonFiniteForce},
                    Cause{"Device", {{0, 0, 4}, 0, bit(ServoFault::kDeviceError)}, ServoFault::kDeviceError},
                    Cause{"Reports", {{0, 0, 4}, 0, 0, 1'000'000, 20'000'001}, ServoFault::kDroppedReports},
                    Cause{"Surface", {{0, 0, 4}, 0, bit(ServoFault::kSurfaceLost)}, ServoFault::kSurfaceLost},
                    Cause{"Plane", {{0, 0, 4}, 0, bit(ServoFault::kPlaneBehind)}, ServoFault::kPlaneBehind},
                    Cause{"Clock", {{0, 0, 4}, 0, bit(ServoFault::kClockStep)}, ServoFault::kClockStep}),
    [](const auto& cause) { return std::string(cause.param.name); });

TEST(SafetyGate, NotesDoNotTakeTheForceAway) {
  TakingGate gate(parameters(), 1000);
  const std::uint32_t notes =
      bit(ServoFault::kOverrun) | bit(ServoFault::kZeroGradient) | bit(ServoFault::kInsideObject);
  EXPECT_EQ(gate.pass({{0, 0, 4}, 0, notes}).force_W.z(), 4);
}

// A position of 20 ms, a window of 0.5 s, and a tick 10 ms after it was due, which is 11 ms after the last.
TEST(SafetyGate, AgeAtTheLimitIsFresh) {
  TakingGate gate(parameters(), 1000);
  EXPECT_EQ(gate.pass({{0, 0, 4}, 500'000'000, 0, 11'000'000, 20'000'000}).faults, 0u);
}

// The device has held 4 N through the stall. It is let go at once (no slew to speak of), and what comes back starts
// from nothing in the next tick, however long the fault lasted.
TEST(SafetyGate, AfterAStallTheForceStartsFromNothing) {
  TakingGate gate(parameters(), 1000);
  EXPECT_EQ(gate.pass(healthy({0, 0, 4})).force_W.z(), 4);
  const GateOutput out = gate.pass({{0, 0, 6}, 0, 0, 11'000'001});
  EXPECT_EQ(out.faults, bit(ServoFault::kStall));
  EXPECT_TRUE(out.force_W.isZero(0));
  for (int tick = 1; tick <= 12; ++tick) {
    EXPECT_NEAR(gate.pass(healthy({0, 0, 6})).force_W.z(), 6 * std::min(1.0, tick / 10.0), 1e-12);
  }
}

TEST(SafetyGate, AfterAStallTheForceFallsAtTheSlewLimit) {
  SafetyParameters p = parameters();
  p.slew_limit_N_per_s = 1000;  // 1 N a tick
  TakingGate gate(p, 1000);
  for (int i = 0; i < 4; ++i) static_cast<void>(gate.pass(healthy({0, 0, 4})));
  EXPECT_EQ(gate.heldForce().z(), 4);
  EXPECT_NEAR(gate.pass({{0, 0, 4}, 0, 0, 50'000'000}).force_W.z(), 3, 1e-12);
  // The fault goes on as another one: down all the way.
  for (int tick = 1; tick <= 3; ++tick) {
    EXPECT_NEAR(gate.pass({{0, 0, 4}, 0, bit(ServoFault::kDeviceError)}).force_W.z(), 3 - tick, 1e-12);
  }
}

// A device that let its force go by itself, for however short a time, gets it back from nothing, over the whole fade.
TEST(SafetyGate, AfterADevicesOwnPauseTheForceStartsFromNothing) {
  for (const int pause : {1, 3, 40}) {
    SafetyGate gate(parameters(), 1000);
    const auto pass = [&](const GateInput& in, bool exerts) {
      const GateOutput out = gate.pass(in);
      gate.taken(exerts ? out.force_W : Vec3(Vec3::Zero()));
      return out;
    };
    for (int i = 0; i < 3; ++i) static_cast<void>(pass(healthy({0, 0, 4}), true));
    for (int i = 0; i < pause; ++i) {
      const GateOutput out = pass({{0, 0, 4}, 0, bit(ServoFault::kForceOff)}, false);
      EXPECT_EQ(out.faults, bit(ServoFault::kForceOff));
      EXPECT_TRUE(out.force_W.isZero(0));
    }
    for (int tick = 1; tick <= 12; ++tick)
      EXPECT_NEAR(pass(healthy({0, 0, 4}), true).force_W.z(), 4 * std::min(1.0, tick / 10.0), 1e-12);
  }
}

// Nor while another fault goes on after it: a fade gives nothing back.
TEST(SafetyGate, AFadeGivesNothingBack) {
  SafetyGate gate(parameters(), 1000);
  gate.taken(gate.pass(healthy({0, 0, 4})).force_W);
  gate.taken(gate.pass({{0, 0, 4}, 0, bit(ServoFault::kDeviceError)}).force_W);
  gate.taken({0, 0, 1});  // the device cut it
  EXPECT_NEAR(gate.pass({{0, 0, 4}, 0, bit(ServoFault::kDeviceError)}).force_W.z(), 1, 1e-12);
  gate.taken({0, 0, 1});
  for (int tick = 0; tick < 10; ++tick) {
    const GateOutput out = gate.pass({{0, 0, 4}, 0, bit(ServoFault::kDeviceError)});
    EXPECT_LE(out.force_W.z(), gate.heldForce().z());
    gate.taken(out.force_W);
  }
  EXPECT_TRUE(gate.heldForce().isZero(0));
}

// In the middle of a fade, a stall takes the rest.
TEST(SafetyGate, AStallEndsAFade) {
  TakingGate gate(parameters(), 1000);
  EXPECT_EQ(gate.pass(healthy({0, 0, 4})).force_W.z(), 4);
  EXPECT_NEAR(gate.pass({{0, 0, 4}, 0, bit(ServoFault::kNoWindow)}).force_W.z(), 3.6, 1e-12);
  EXPECT_TRUE(gate.pass({{0, 0, 4}, 0, bit(ServoFault::kNoWindow), 50'000'000}).force_W.isZero(0));
}

// 8 N at 0.5 N a tick need 16 ticks at least; the fade of 10 ticks becomes longer, and keeps within the slew.
TEST(SafetyGate, AFadeIsNoFasterThanTheSlewLimit) {
  SafetyParameters p = parameters();
  p.slew_limit_N_per_s = 500;
  TakingGate gate(p, 1000);
  EXPECT_EQ(gate.fadeTicks(), 17);
  for (int i = 0; i < 20; ++i) static_cast<void>(gate.pass(healthy({0, 0, 9})));
  EXPECT_EQ(gate.heldForce().z(), 8);
  for (int tick = 1; tick <= 17; ++tick) {
    EXPECT_NEAR(gate.pass({{0, 0, 9}, 0, bit(ServoFault::kNoWindow)}).force_W.z(), 8 * (1 - tick / 17.0), 1e-12);
  }
  EXPECT_TRUE(gate.heldForce().isZero(0));
}

// ---- the end of a run ----

// Tick by tick the same as a fault's fade, from health, from within a fade, and while the force still comes back.
TEST(SafetyGate, AReleaseFadesAsAFaultDoes) {
  const GateInput faulty{{0, 0, 4}, 0, bit(ServoFault::kNoWindow)};
  for (const int faulty_before : {0, 3, 9, 10, 20}) {
    for (const int healthy_before : {0, 1, 4, 10}) {
      TakingGate fades(parameters(), 1000), ends(parameters(), 1000);
      for (TakingGate* gate : {&fades, &ends}) {
        for (int i = 0; i < 3; ++i) static_cast<void>(gate->pass(healthy({0, 0, 4})));
        for (int i = 0; i < faulty_before; ++i) static_cast<void>(gate->pass(faulty));
        for (int i = 0; i < healthy_before; ++i) static_cast<void>(gate->pass(healthy({0, 0, 4})));
      }
      for (int tick = 1; tick <= 12; ++tick)
        EXPECT_NEAR(ends.release().z(), fades.pass(faulty).force_W.z(), 1e-12) << faulty_before << ' ' << tick;
      EXPECT_TRUE(ends.heldForce().isZero(0));
    }
  }
}

// 2.5 N at 0.1 N a tick need 25 ticks, and one to spare; a fault's fade would allow for the whole limit of 8 N.
TEST(SafetyGate, AReleaseIsNoFasterThanTheSlewLimit) {
  SafetyParameters p = parameters();
  p.slew_limit_N_per_s = 100;
  SafetyGate gate(p, 1000);
  for (int i = 0; i < 30; ++i) gate.taken(gate.pass(healthy({0, 0, 2.5})).force_W);
  EXPECT_EQ(gate.releaseTicks(), 26);
  for (int tick = 1; tick <= 26; ++tick) {
    gate.taken(gate.release());
    EXPECT_NEAR(gate.heldForce().z(), 2.5 * (1 - tick / 26.0), 1e-12);
  }
  EXPECT_TRUE(gate.heldForce().isZero(0));
}

// However little the slew limit allows: what was built up in 100 ticks is gone in as many and one, or in the fade time.
TEST(SafetyGate, AReleaseTakesNoLongerThanWhatIsHeldAsksFor) {
  SafetyParameters p = parameters();
  p.slew_limit_N_per_s = 1e-6;
  SafetyGate gate(p, 1000);
  for (int i = 0; i < 100; ++i) gate.taken(gate.pass(healthy({0, 0, 2.5})).force_W);
  ASSERT_GT(gate.heldForce().z(), 0);
  EXPECT_NEAR(static_cast<double>(gate.releaseTicks()), 101, 1);  // sums of 1 nN are rounded
}

// While the device refuses, the fade's time passes; after a stall the rest goes at the slew.
TEST(SafetyGate, AStallInAReleaseTakesTheRest) {
  SafetyParameters p = parameters();
  p.slew_limit_N_per_s = 1000;  // 1 N a tick
  TakingGate gate(p, 1000);
  for (int i = 0; i < 4; ++i) static_cast<void>(gate.pass(healthy({0, 0, 4})));
  EXPECT_NEAR(gate.release().z(), 3.6, 1e-12);
  for (const double left_N : {2.6, 1.6, 0.6, 0.0}) EXPECT_NEAR(gate.release(50'000'000).z(), left_N, 1e-12);
}

// ---- the start ----

SafetyParameters slowStart() {
  SafetyParameters p = parameters();
  p.start_s = 0.1;  // 100 ticks; a fade has 10
  return p;
}

TEST(SafetyGate, TheForceOfAHeldDeviceBeginsAtNothing) {
  TakingGate gate(slowStart(), 1000);
  for (int tick = 1; tick <= 110; ++tick)
    EXPECT_NEAR(gate.pass(healthy({0, 0, 4})).force_W.z(), 4 * std::min(1.0, tick / 100.0), 1e-12);
}

// A fault stops the start, and the force comes back to where it was; only healthy ticks count.
TEST(SafetyGate, AFaultDoesNotHastenTheStart) {
  TakingGate gate(slowStart(), 1000);
  const GateInput faulty{{0, 0, 4}, 0, bit(ServoFault::kStaleWindow)};
  for (int i = 0; i < 50; ++i) static_cast<void>(gate.pass(faulty));
  for (int i = 0; i < 20; ++i) static_cast<void>(gate.pass(healthy({0, 0, 4})));
  EXPECT_NEAR(gate.heldForce().z(), 4 * 0.2, 1e-12);
  for (int tick = 1; tick <= 10; ++tick) EXPECT_NEAR(gate.pass(faulty).force_W.z(), 4 * 0.2 * (1 - tick / 10.0), 1e-12);
  for (int tick = 1; tick <= 15; ++tick) {
    EXPECT_NEAR(gate.pass(healthy({0, 0, 4})).force_W.z(), 4 * std::min(1.0, tick / 10.0) * (0.2 + 0.01 * tick), 1e-12);
  }
}

// What is held fades first, in its own direction, then the new force comes as at the start.
TEST(SafetyGate, WhatBeginsAnewFadesAndComesBack) {
  TakingGate gate(slowStart(), 1000);
  for (int i = 0; i < 120; ++i) static_cast<void>(gate.pass(healthy({0, 0, 4})));
  ASSERT_EQ(gate.heldForce().z(), 4);
  gate.beginAnew();
  for (int tick = 1; tick <= 10; ++tick) {
    const GateOutput out = gate.pass(healthy({3, 0, 0}));
    EXPECT_LT((out.force_W - Vec3(0, 0, 4 * (1 - tick / 10.0))).norm(), 1e-12) << tick;
    EXPECT_EQ(out.faults, 0U);
  }
  for (int tick = 1; tick <= 110; ++tick) {
    const double share = std::min(1.0, tick / 10.0) * std::min(1.0, tick / 100.0);
    EXPECT_LT((gate.pass(healthy({3, 0, 0})).force_W - Vec3(3 * share, 0, 0)).norm(), 1e-12) << tick;
  }
}

// The promise behind all of it, with everything at random: no force is above the limit times the share of the fade
// times the share of the start that have passed, as a model of a few lines counts them. What was held when all begins
// anew fades first, from what it was allowed before.
TEST(SafetyGate, NoForceIsAboveItsAuthority) {
  for (unsigned seed = 0; seed < 500; ++seed) {
    SCOPED_TRACE(seed);
    Seeded random(seed);
    SafetyParameters p = parameters();
    p.force_limit_N = random.logBetween(0.1, 50);
    p.fade_s = random.between(0, 0.1);
    p.start_s = random.pick(4) == 0 ? 0 : random.between(0, 0.5);
    p.slew_limit_N_per_s = 1e9;
    SafetyGate gate(p, 1000);
    const double start_ticks = p.start_s * 1000, fade_ticks = static_cast<double>(gate.fadeTicks());
    double started = 0, authority = fade_ticks, share = start_ticks > 0 ? 0 : 1, share_before = 0;
    bool lets_go = false;
    int spell = 0;
    for (int tick = 0; tick < 1000; ++tick) {
      if (spell-- <= 0) spell = random.pick(100);
      const bool faulty = spell < 15, is_off = faulty && seed % 2 == 0;
      if (random.pick(200) == 0) {
        gate.beginAnew();
        started = 0;
        lets_go = true;
        share_before = std::max(share_before, share);
      }
      GateInput in = healthy(100 * random.direction());
      if (faulty) in.faults = bit(is_off ? ServoFault::kForceOff : ServoFault::kStaleWindow);
      if (is_off) authority = 0;
      if (faulty || lets_go) {
        authority = std::max(0.0, authority - 1);
        lets_go = lets_go && authority > 0;
      } else {
        authority = std::min(fade_ticks, authority + 1);
        started += 1;
      }
      share = start_ticks > 0 ? std::min(1.0, started / start_ticks) : 1;
      if (authority == 0) share_before = 0;
      gate.taken(gate.pass(in).force_W);
      ASSERT_LE(gate.heldForce().norm(),
                p.force_limit_N * authority / fade_ticks * std::max(share, share_before) * (1 + 1e-9))
          << tick;
    }
  }
}

// Healthy again in the middle of a fade: it goes on from the authority reached, not from full force.
TEST(SafetyGate, RecoversFromWhereTheFadeWas) {
  TakingGate gate(parameters(), 1000);
  EXPECT_EQ(gate.pass(healthy({0, 0, 4})).force_W.z(), 4);
  for (int i = 0; i < 5; ++i) static_cast<void>(gate.pass({{0, 0, 4}, 0, bit(ServoFault::kNoWindow)}));
  EXPECT_NEAR(gate.heldForce().z(), 2, 1e-12);
  EXPECT_NEAR(gate.pass(healthy({0, 0, 4})).force_W.z(), 2.4, 1e-12);
  // And a fade that begins there takes no longer than what is left.
  for (int tick = 1; tick <= 6; ++tick) {
    EXPECT_NEAR(gate.pass({{0, 0, 4}, 0, bit(ServoFault::kNoWindow)}).force_W.z(), 2.4 * (1 - tick / 6.0), 1e-12);
  }
}

TEST(SafetyGate, NoFadeTimeMeansZeroAtOnce) {
  SafetyParameters p = parameters();
  p.fade_s = 0;
  TakingGate gate(p, 1000);
  EXPECT_EQ(gate.pass(healthy({0, 0, 4})).force_W.z(), 4);
  EXPECT_TRUE(gate.pass({{0, 0, 4}, 0, bit(ServoFault::kDeviceError)}).force_W.isZero(0));
}

TEST(SafetyGate, FadeTicksFollowTimeAndRate) {
  SafetyParameters p = parameters();
  p.fade_s = 0.1;
  EXPECT_EQ(SafetyGate(p, 1000).fadeTicks(), 100);
  EXPECT_EQ(SafetyGate(p, 20000).fadeTicks(), 2000);
}

// ---- refused offers ----

// 4 N held, then ten offers refused: the fade goes on meanwhile, but the device holds 4 N, so the offers stay one slew
// away from that, and so does the first that is taken.
TEST(SafetyGate, AfterRefusedOffersTheForceFallsFromWhatTheDeviceHolds) {
  SafetyParameters p = parameters();
  p.slew_limit_N_per_s = 1000;  // 1 N a tick; 10 ticks of fade
  SafetyGate gate(p, 1000);
  const GateInput refused{{0, 0, 4}, 0, bit(ServoFault::kDeviceError)};
  for (int i = 0; i < 4; ++i) gate.taken(gate.pass(healthy({0, 0, 4})).force_W);
  ASSERT_EQ(gate.heldForce().z(), 4);
  for (int tick = 1; tick <= 10; ++tick) {
    EXPECT_NEAR(gate.pass(refused).force_W.z(), std::max(3.0, 4 * (1 - tick / 10.0)), 1e-12) << tick;
    EXPECT_EQ(gate.heldForce().z(), 4) << tick;
  }
  // Taken from now on: down at the slew, then up again with an authority that began at nothing.
  const GateOutput first = gate.pass(refused);
  EXPECT_NEAR(first.force_W.z(), 3, 1e-12);
  gate.taken(first.force_W);
  const double expected_N[] = {2, 1, 1.2, 1.6, 2.0, 2.4, 2.8, 3.2, 3.6, 4, 4};  // max(3 - k, 4 k / 10), then 4
  for (int k = 1; k <= 11; ++k) {
    const GateOutput out = gate.pass(healthy({0, 0, 4}));
    EXPECT_NEAR(out.force_W.z(), expected_N[k - 1], 1e-12) << k;
    EXPECT_EQ(has(out.faults, ServoFault::kSlewLimited), k <= 2) << k;  // it still lets go of the old force
    gate.taken(out.force_W);
  }
}

// What is wanted after a release comes back from nothing, as after a stall.
TEST(SafetyGate, AfterAReleaseTheForceStartsFromNothing) {
  TakingGate gate(parameters(), 1000);
  EXPECT_EQ(gate.pass(healthy({0, 0, 4})).force_W.z(), 4);
  for (int i = 0; i < 10; ++i) static_cast<void>(gate.release());
  EXPECT_TRUE(gate.heldForce().isZero(0));
  for (int tick = 1; tick <= 10; ++tick) {
    EXPECT_NEAR(gate.pass(healthy({0, 0, 4})).force_W.z(), 0.4 * tick, 1e-12);
  }
}

// An offer of 6 N is refused while all is well otherwise: the fade that follows begins at the 4 N that are held.
TEST(SafetyGate, AFadeBeginsAtWhatTheDeviceHolds) {
  SafetyGate gate(parameters(), 1000);
  gate.taken(gate.pass(healthy({0, 0, 4})).force_W);
  EXPECT_EQ(gate.pass(healthy({0, 0, 6})).force_W.z(), 6);
  for (int tick = 1; tick <= 10; ++tick) {
    const GateOutput out = gate.pass({{0, 0, 6}, 0, bit(ServoFault::kDeviceError)});
    EXPECT_NEAR(out.force_W.z(), 4 * (1 - tick / 10.0), 1e-12);
    gate.taken(out.force_W);
  }
}

// The fade's time passes meanwhile, but no offer is more than a slew away from the 2 N that are held.
TEST(SafetyGate, RefusedOffersOfAReleaseAreMadeAgain) {
  SafetyParameters p = parameters();
  p.slew_limit_N_per_s = 1000;
  SafetyGate gate(p, 1000);
  for (int i = 0; i < 2; ++i) gate.taken(gate.pass(healthy({0, 0, 2})).force_W);
  for (int tick = 1; tick <= 12; ++tick)
    EXPECT_NEAR(gate.release().z(), std::max(1.0, 2 * (1 - tick / 10.0)), 1e-12) << tick;
  gate.taken(gate.release());
  EXPECT_NEAR(gate.heldForce().z(), 1, 1e-12);
  EXPECT_TRUE(gate.release().isZero(0));
}

// A device that cuts what it is given to 1.5 N: the next offer is a slew from there, not from the offer before.
TEST(SafetyGate, GoesOnFromWhatTheDeviceMadeOfTheOffer) {
  SafetyParameters p = parameters();
  p.slew_limit_N_per_s = 1000;
  SafetyGate gate(p, 1000);
  for (int i = 0; i < 5; ++i) {
    const GateOutput out = gate.pass(healthy({0, 0, 8}));
    EXPECT_NEAR(out.force_W.z(), std::min(1.0 + i, 2.5), 1e-12);
    gate.taken(out.force_W.cwiseMin(Vec3::Constant(1.5)));
  }
  EXPECT_NEAR(gate.pass(healthy({0, 0, 0})).force_W.z(), 0.5, 1e-12);
}

// What cannot be: the offer counts, or no force would ever leave again.
TEST(SafetyGate, DoesNotBelieveADeviceThatHoldsNoForceWithinTheLimit) {
  for (const Vec3& nonsense : {Vec3(0, kNaN, 0), Vec3(0, 0, INFINITY), Vec3(0, 0, -8.001)}) {
    SafetyGate gate(parameters(), 1000);
    gate.taken(gate.pass(healthy({1, 2, 3})).force_W);
    static_cast<void>(gate.pass(healthy({1, 2, 2})));
    gate.taken(nonsense);
    EXPECT_EQ(gate.heldForce(), Vec3(1, 2, 2));
    gate.taken(Vec3(0, 0, -8));  // the limit itself
    EXPECT_EQ(gate.heldForce(), Vec3(0, 0, -8));
  }
}

// Limits that change at random, in health, in fades, while the device refuses: no step is longer than the slew, no
// force grows beyond the limit of its tick, what is above a new limit only comes down, and a fade never grows.
TEST(SafetyGate, AnotherForceLimitAtAnyMomentKeepsEveryPromise) {
  for (unsigned seed = 0; seed < 400; ++seed) {
    SCOPED_TRACE(seed);
    Seeded random(seed);
    SafetyParameters p = parameters();
    p.force_limit_N = random.logBetween(0.01, 50);
    p.slew_limit_N_per_s = random.logBetween(5, 1e6);
    p.fade_s = random.pick(3) == 0 ? 0 : random.between(0, 0.2);
    SafetyGate gate(p, 1000);
    const double slew_N = p.slew_limit_N_per_s / 1000;
    bool was_faulty = false;
    int spell = 0;
    for (int tick = 0; tick < 600; ++tick) {
      if (random.pick(25) == 0) {
        gate.setForceLimit(random.logBetween(0.01, 50));
        EXPECT_GE(gate.fadeTicks(), 1);
      }
      if (spell-- <= 0) spell = random.pick(60);
      const bool faulty = spell < 20;
      GateInput in = healthy(random.inCube(30));
      if (faulty) in.faults = bit(ServoFault::kDeviceError);
      const Vec3 held_W = gate.heldForce();
      const Vec3 offer_W = gate.pass(in).force_W;
      ASSERT_TRUE(offer_W.allFinite());
      ASSERT_LE((offer_W - held_W).norm(), slew_N * (1 + 1e-9));
      ASSERT_LE(offer_W.norm(), std::max(gate.forceLimit(), held_W.norm()) * (1 + 1e-9));
      ASSERT_TRUE(!faulty || !was_faulty || offer_W.norm() <= held_W.norm() * (1 + 1e-9)) << tick;
      was_faulty = faulty;
      if (random.pick(5) != 0) gate.taken(offer_W);
    }
  }
}

// From 8 N to 2 N the authority of a fade stays its share, and comes back to the whole of the new limit.
TEST(SafetyGate, AnotherForceLimitIsReachedAndComesBack) {
  TakingGate gate(parameters(), 1000);
  EXPECT_NEAR(gate.pass(healthy({0, 0, 20})).force_W.z(), 8, 1e-12);
  gate.setForceLimit(2);
  const GateOutput lower = gate.pass(healthy({0, 0, 20}));
  EXPECT_NEAR(lower.force_W.z(), 2, 1e-12);
  EXPECT_EQ(lower.faults, bit(ServoFault::kForceLimited));
  gate.setForceLimit(5);
  EXPECT_NEAR(gate.pass(healthy({0, 0, 20})).force_W.z(), 5, 1e-12);
  EXPECT_EQ(gate.pass(healthy({0, 0, 5})).faults, 0U);
}

// A fade that must take longer under a higher limit does so from where it is.
TEST(SafetyGate, AHigherLimitMakesAFadeAsLongAsItsSlewAsks) {
  SafetyParameters p = parameters();  // 10 ticks by time
  p.slew_limit_N_per_s = 500;         // 0.5 N a tick: 8 N in 17 ticks, 16 N in 33
  SafetyGate gate(p, 1000);
  EXPECT_EQ(gate.fadeTicks(), 17);
  gate.setForceLimit(16);
  EXPECT_EQ(gate.fadeTicks(), 33);
  gate.setForceLimit(1);
  EXPECT_EQ(gate.fadeTicks(), 10);
}

// 5 of 17 ticks into a fade from 8 N the authority is 12 / 17; of the 33 ticks that 16 N need that is 23, rounded down.
// The fade goes on from what is held, and what comes back has 23 / 33 of what is wanted.
TEST(SafetyGate, AnotherForceLimitKeepsTheShareOfAFade) {
  SafetyParameters p = parameters();
  p.slew_limit_N_per_s = 500;  // 0.5 N a tick
  TakingGate gate(p, 1000);
  for (int i = 0; i < 20; ++i) static_cast<void>(gate.pass(healthy({0, 0, 8})));
  const GateInput faulty{{0, 0, 8}, 0, bit(ServoFault::kNoWindow)};
  for (int i = 0; i < 5; ++i) static_cast<void>(gate.pass(faulty));
  const double held_N = 8 * 12 / 17.0;
  ASSERT_NEAR(gate.heldForce().z(), held_N, 1e-12);
  gate.setForceLimit(16);
  EXPECT_NEAR(gate.pass(faulty).force_W.z(), held_N * 22 / 23, 1e-12);
  EXPECT_NEAR(gate.pass(healthy({0, 0, 8})).force_W.z(), 8 * 23 / 33.0, 1e-12);
}

// Whole authority stays whole, though the fade takes more ticks.
TEST(SafetyGate, AnotherForceLimitTakesNothingFromAHealthyForce) {
  SafetyParameters p = parameters();
  p.slew_limit_N_per_s = 500;
  TakingGate gate(p, 1000);
  gate.setForceLimit(16);
  EXPECT_EQ(gate.pass(healthy({0, 0, 0.4})).force_W.z(), 0.4);
}

TEST(SafetyGate, RefusesLimitsThatAreNone) {
  const auto refused = [](SafetyParameters p, double rate_hz = 1000) { EXPECT_THROW(SafetyGate(p, rate_hz), Error); };
  refused({0, 1, 0.1, 0.5});
  refused({kNaN, 1, 0.1, 0.5});
  refused({8, 0, 0.1, 0.5});
  refused({8, 1, -0.1, 0.5});
  refused({8, 1, kNaN, 0.5});
  refused({8, 1, 0.1, -1});
  refused({8, 1, 0.1, 0.5, -1});
  refused({8, 1, 0.1, 0.5, kNaN});
  refused({8, 1, 0.1, 0.5, 0.01, -1});
  refused({8, 1, 0.1, 0.5, 0.01, kNaN});
  refused({8, 1, 60.1, 0.5});
  refused({8, 1, 0.1, 1.1e6});
  refused({8, 1, 0.1, 0.5, 1.1e6});
  refused({8, 1, 0.1, 0.5, 0.01, 1.1e6});
  refused({INFINITY, 1, 0.1, 0.5});
  refused({8, INFINITY, 0.1, 0.5});
  refused(parameters(), 0);
  refused(parameters(), INFINITY);
  refused(parameters(), kNaN);
}

TEST(SafetyGate, TakesTheEndsOfTheRanges) {
  EXPECT_NO_THROW(SafetyGate({8, 1, 0, 0, 0, 0}, 1000));
  EXPECT_NO_THROW(SafetyGate({8, 1, 60, 1e6, 1e6, 1e6}, 1000));
}

// A slew so small that no count of ticks holds the fade: it is as long as can be said.
TEST(SafetyGate, ASlewOfNextToNothingStillHasAFade) {
  SafetyParameters p = parameters();
  p.slew_limit_N_per_s = 1e-300;
  SafetyGate gate(p, 1000);
  EXPECT_GE(gate.fadeTicks(), 1'000'000'000'000'000);
  EXPECT_LE(gate.pass(healthy({0, 0, 4})).force_W.norm(), gate.slewPerTick());
}

}  // namespace safety_gate_test
}  // namespace palpate
