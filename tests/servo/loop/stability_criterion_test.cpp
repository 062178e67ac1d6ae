// SPDX-License-Identifier: Apache-2.0
// Each clause of the criterion by which a contact is called unstable, on records made by hand.
#include <cmath>
#include <functional>

#include <gtest/gtest.h>

#include "servo/loop/contact_stability.hpp"
#include "servo/loop/swing_watch.hpp"
#include "servo/safety/faults.hpp"
#include "wanted_path.hpp"

namespace palpate {
namespace stability_criterion_test {

// A tool that swings to and fro through the plane z = 0 while the hand wants it 1 mm below; 1 mJ is given a second.
struct HandMade {
  double hz = 30, seconds = 1, amplitude_m = 0.1e-3;
  double keeps_a_second = 1;  // of the amplitude
  double given_J_per_s = 1e-3;
  double path_at_m = -1e-3;
  double rest_m = 0;     // about which the tool swings
  double path_m = 0;     // the path swings too, by this
  double surface_m = 0;  // and the surface
  double resolution_m = 0;
  bool path_known = true;
  std::function<void(TickRecord&)> change = [](TickRecord&) {};
};

ContactStability assess(const HandMade& made) {
  std::vector<TickRecord> records(static_cast<std::size_t>(1000 * made.seconds));
  for (std::size_t i = 0; i < records.size(); ++i) {
    TickRecord& r = records[i];
    r.tick = static_cast<std::int64_t>(i);
    r.time_s = static_cast<double>(i) / 1000;
    const double wave = std::sin(2 * M_PI * made.hz * (r.time_s + 1e-5));
    r.hip_W[2] = made.rest_m + made.amplitude_m * std::pow(made.keeps_a_second, r.time_s) * -wave;
    r.in_contact = r.hip_W[2] < 0;
    const double surface_m = -made.surface_m * wave;  // down where the tool presses
    r.vhip_W[2] = r.in_contact ? surface_m : r.hip_W[2];
    if (r.in_contact) r.normal_W[2] = 1;
    if (r.in_contact) r.depth_m = surface_m - r.hip_W[2];
    r.energy_J = -made.given_J_per_s * r.time_s;
    made.change(r);
  }
  const WantedPath path(
      [&](double t_s) { return Vec3(0, 0, made.path_at_m + made.path_m * std::sin(2 * M_PI * made.hz * t_s)); });
  return assessContact(records, {.resolution_m = made.resolution_m, .path = made.path_known ? &path : nullptr});
}

bool unstable(const HandMade& made) {
  return assess(made).verdict == ContactVerdict::kUnstable;
}

TEST(StabilityCriterion, SwingsThatLastAreUnstable) {
  const ContactStability s = assess(HandMade{});
  EXPECT_EQ(s.verdict, ContactVerdict::kUnstable);
  EXPECT_NEAR(s.swing_m, 0.2e-3, 0.02e-3);  // sampled at 33 points a period: turns are met within 1 %
  EXPECT_NEAR(s.swing_hz, 30, 1);
  EXPECT_EQ(s.bounces, 30);
  EXPECT_LT(s.unstable_from_s, 0.05);
  EXPECT_GT(s.unstable_to_s, 0.93);
}

// 20 swings are 10 periods, and the first and last turn are half a period from the ends.
TEST(StabilityCriterion, TwentySwingsInARow) {
  EXPECT_FALSE(unstable({.seconds = 10.0 / 30}));
  EXPECT_TRUE(unstable({.seconds = 12.0 / 30}));
}

// Halves are 5 periods apart, a sixth of a second: what is kept of it is to be 0.75 at least.
TEST(StabilityCriterion, SwingsThatDieAwayAreNone) {
  EXPECT_FALSE(unstable({.keeps_a_second = std::pow(0.7, 6)}));
  EXPECT_TRUE(unstable({.keeps_a_second = std::pow(0.8, 6)}));
  EXPECT_TRUE(unstable({.keeps_a_second = 2}));
}

TEST(StabilityCriterion, SwingsThatTheSurfaceDoesNotFeedAreNone) {
  EXPECT_FALSE(unstable({.given_J_per_s = -1e-3}));
  EXPECT_FALSE(unstable({.given_J_per_s = 0}));
}

// A path that goes a tenth of the way as well, or a surface that goes a fortieth.
TEST(StabilityCriterion, SwingsThatPathOrSurfaceAskForAreNone) {
  EXPECT_TRUE(unstable({.path_m = 0.08 * 0.1e-3}));
  EXPECT_FALSE(unstable({.path_m = 0.12 * 0.1e-3}));
  EXPECT_TRUE(unstable({.rest_m = -1e-3, .surface_m = 0.02 * 0.1e-3}));
  EXPECT_FALSE(unstable({.rest_m = -1e-3, .surface_m = 0.03 * 0.1e-3}));
}

// A tool that leaves the surface in every period against the hand's wish bounces, whatever the surface is like; where
// the hand asks for it, it taps.
TEST(StabilityCriterion, BouncesThatTheHandDoesNotAskForAreUnstable) {
  EXPECT_TRUE(unstable({.surface_m = 0.4 * 0.1e-3}));
  EXPECT_FALSE(unstable({.path_m = 0.12 * 0.1e-3, .surface_m = 0.4 * 0.1e-3}));
}

// Every period of the ten must bounce: with nine the tool taps now and then on a surface that swings.
TEST(StabilityCriterion, ABounceNowAndThenIsNone) {
  const auto stays_in = [](int periods_of_ten) {
    return HandMade{.surface_m = 0.4 * 0.1e-3, .change = [=](TickRecord& r) {
                      if (static_cast<int>(r.time_s * 30) % 10 >= periods_of_ten) return;
                      r.in_contact = true;
                      r.normal_W[2] = 1;
                      r.vhip_W[2] = 0.4 * r.hip_W[2];  // the surface, which swings with the tool
                      r.depth_m = r.vhip_W[2] - r.hip_W[2];
                    }};
  };
  EXPECT_TRUE(unstable(stays_in(0)));
  EXPECT_FALSE(unstable(stays_in(1)));
  EXPECT_FALSE(unstable(stays_in(3)));
}

// What an effect puts on the surface asks for swings of its own; what is in proportion to the depth is stiffness.
TEST(StabilityCriterion, WhatEffectsPutOnTheSurfaceCountsUnlessItIsStiffness) {
  const auto put_on = [](double share, double height_m) {
    return HandMade{.rest_m = -1e-3, .change = [=](TickRecord& r) {
                      r.vhip_W[2] += share * r.depth_m + height_m * std::sin(2 * M_PI * 30 * r.time_s);
                    }};
  };
  EXPECT_TRUE(unstable(put_on(0, 0)));
  EXPECT_TRUE(unstable(put_on(19, 0)));
  EXPECT_TRUE(unstable(put_on(0, 0.02 * 0.1e-3)));
  EXPECT_FALSE(unstable(put_on(0, 0.033 * 0.1e-3)));
}

TEST(StabilityCriterion, SwingsOfTwoEncoderStepsAreRoundings) {
  EXPECT_FALSE(unstable({.resolution_m = 0.2e-3 / 2}));
  EXPECT_TRUE(unstable({.resolution_m = 0.2e-3 / 3}));
  EXPECT_FALSE(unstable({.hz = 160, .amplitude_m = 0.9e-6}));  // 1.8 um
  EXPECT_TRUE(unstable({.hz = 160, .amplitude_m = 1.4e-6}));
}

// A finger feels swings of twice 20 um at 10 Hz, 10 um at 40 Hz, 1.6 um at 100 Hz. Turns are met within 5 % at 10
// points a period.
TEST(StabilityCriterion, SwingsThatNoFingerFeelsAreNone) {
  EXPECT_NEAR(SwingWatch::leastFelt(10), 40e-6, 1e-9);
  EXPECT_NEAR(SwingWatch::leastFelt(40), 20e-6, 1e-9);
  EXPECT_NEAR(SwingWatch::leastFelt(100), 3.2e-6, 1e-9);
  EXPECT_NEAR(SwingWatch::leastFelt(250), 0.512e-6, 1e-9);
  EXPECT_EQ(SwingWatch::leastFelt(1000), SwingWatch::leastFelt(250));
  for (const double hz : {13.0, 30.0, 60.0, 100.0}) {
    const double amplitude_m = SwingWatch::leastFelt(hz) / 2;
    for (const bool path_known : {false, true}) {
      EXPECT_FALSE(unstable({.hz = hz, .amplitude_m = 0.9 * amplitude_m, .path_known = path_known})) << hz;
      EXPECT_TRUE(unstable({.hz = hz, .amplitude_m = 1.1 * amplitude_m, .path_known = path_known})) << hz;
    }
  }
}

TEST(StabilityCriterion, WithoutAPathAHandsSwingsAreNone) {
  EXPECT_FALSE(unstable({.hz = 10, .seconds = 3, .path_known = false}));
  EXPECT_TRUE(unstable({.hz = 15, .seconds = 3, .path_known = false}));
  EXPECT_TRUE(unstable({.hz = 10, .seconds = 3}));
}

// Each of these comes every quarter of a second, 15 swings.
bool everyQuarter(const TickRecord& r) {
  return r.tick % 250 == 249;
}

TEST(StabilityCriterion, AFaultAnEndOfTheSurfaceOrALongFlightStartTheCountAnew) {
  EXPECT_FALSE(unstable({.seconds = 3, .change = [](TickRecord& r) {
                           if (everyQuarter(r)) r.faults = bit(ServoFault::kDeviceError);
                         }}));
  EXPECT_TRUE(unstable({.seconds = 3, .change = [](TickRecord& r) {
                          if (everyQuarter(r)) r.faults = bit(ServoFault::kOverrun);  // only a note
                        }}));
  EXPECT_FALSE(unstable({.seconds = 3, .change = [](TickRecord& r) {
                           if (!everyQuarter(r)) return;
                           r.in_contact = false;
                           r.hip_W[2] = r.vhip_W[2] = -0.05e-3;
                         }}));
  // In the air for 0.6 or 0.4 of each 0.9 s.
  const auto flying = [](double flight_s) {
    return HandMade{.seconds = 6, .change = [flight_s](TickRecord& r) {
                      if (std::fmod(r.time_s, 0.9) < 0.3 || std::fmod(r.time_s, 0.9) > 0.3 + flight_s) return;
                      r.in_contact = false;
                      r.hip_W[2] = 0.05e-3;
                    }};
  };
  EXPECT_FALSE(unstable(flying(0.6)));
  EXPECT_TRUE(unstable(flying(0.4)));
}

// Lost inwards, or with the hand outside too, it is no bounce.
TEST(StabilityCriterion, ABounceIsOutwardsAgainstTheHand) {
  EXPECT_EQ(assess(HandMade{.path_m = 0}).bounces, 30);
  EXPECT_EQ(assess(HandMade{.change = [](TickRecord& r) { r.hip_W[2] = -std::abs(r.hip_W[2]); }}).bounces, 0);
  EXPECT_EQ(assess(HandMade{.path_at_m = 1e-3}).bounces, 0);
  EXPECT_EQ(assess(HandMade{.path_known = false}).bounces, 0);
}

}  // namespace stability_criterion_test
}  // namespace palpate
