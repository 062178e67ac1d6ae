// SPDX-License-Identifier: Apache-2.0
// The verdict on a contact, from runs of the loop, against what must be true of them: the eigenvalues of the sampled
// loop, and paths that leave, tap and slide on purpose.
#include "servo/loop/contact_stability.hpp"

#include <algorithm>
#include <cmath>
#include <functional>
#include <random>

#include <gtest/gtest.h>

#include "servo/loop/swing_watch.hpp"
#include "tests/support/long_run.hpp"
#include "wall_trials.hpp"

namespace palpate {
namespace contact_stability_test {

// Between growing and settling nothing is asked: there the half-open contact, which the linear loop does not know,
// decides.
TEST(ContactStability, AgreesWithTheEigenvaluesOfTheSampledLoop) {
  std::mt19937 random(7);
  const auto between = [&](double low, double high) {
    return std::uniform_real_distribution<double>(low, high)(random);
  };
  const auto decades = [&](double low, double high) { return std::exp(between(std::log(low), std::log(high))); };
  int stable = 0, unstable = 0;
  for (int i = 0; i < 1500; ++i) {
    Trial run;
    run.stiffness_N_per_m = i % 3 == 0 ? decades(10, 20000) : decades(3000, 20000);
    run.damping_Ns_per_m = i % 2 == 0 ? between(0, 20) : between(0, 3);
    run.rate_hz = i % 3 == 0 ? decades(500, 20000) : decades(500, 2000);
    run.device.hand = Hand::kSpring;
    run.device.dynamics.hand_mass_kg = decades(0.05, 0.5);
    run.device.dynamics.hand_damping_Ns_per_m = decades(0.1, 10);
    run.device.dynamics.hand_stiffness_N_per_m = decades(100, 1000);
    run.device.delay_ticks = i % 4 == 0 ? static_cast<int>(between(0, 5)) : 0;
    run.device.encoder_resolution_m = i % 2 == 0 ? 0 : between(0, 50e-6);
    run.path = press(between(0.5e-3, 3e-3));
    const ContactStability s = assess(run);
    const auto describe = [&] {
      const Mode mode = fastestMode(run, 1);
      return ::testing::Message() << i << ": K " << run.stiffness_N_per_m << " B " << run.damping_Ns_per_m << " rate "
                                  << run.rate_hz << " delay " << run.device.delay_ticks << " encoder "
                                  << run.device.encoder_resolution_m << " growth " << mode.growth_per_s << " at "
                                  << mode.hz << " Hz; bounces " << s.bounces << " swing " << s.swing_m << " from "
                                  << s.unstable_from_s;
    };
    if (grows(run)) {
      ++unstable;
      EXPECT_EQ(s.verdict, ContactVerdict::kUnstable) << describe();
    } else if (settles(run)) {
      ++stable;
      EXPECT_NE(s.verdict, ContactVerdict::kUnstable) << describe();
    }
  }
  EXPECT_GT(stable, 500);
  EXPECT_GT(unstable, 200);
}

// ---- what is no instability ----

// Any stiffness, damping, rate, delay and encoder on a path that taps at up to 8 Hz, shakes in the contact, slides over
// edges. The hand is exactly on the path, so whatever happens is asked for.
TEST(ContactStability, ARigidHandIsNeverUnstable) {
  Dice dice(11);
  int active = 0, quiet = 0;
  for (int i = 0; i < 400; ++i) {
    Trial run;
    run.stiffness_N_per_m = dice.decades(10, 20000);
    run.damping_Ns_per_m = dice.between(0, 20);
    run.rate_hz = dice.decades(500, 20000);
    run.device.delay_ticks = dice.coin() ? 0 : static_cast<int>(dice.between(0, 6));
    run.device.encoder_resolution_m = dice.coin() ? 0 : dice.between(0, 50e-6);
    const double hz = dice.decades(0.3, 8), deep_m = dice.between(0.2e-3, 3e-3), high_m = dice.between(-1, 1) * deep_m;
    const double slope = dice.between(-0.3, 0.3);
    run.ground.height = [=](double x_m) { return slope * x_m + (std::fmod(x_m, 4e-3) > 2e-3 ? -1e-3 : 0); };
    run.path = [=](double t_s) {
      return Vec3(5e-3 * t_s, 0, (high_m - deep_m) / 2 + (high_m + deep_m) / 2 * std::cos(2 * M_PI * hz * t_s));
    };
    const ContactStability s = assess(run);
    EXPECT_NE(s.verdict, ContactVerdict::kUnstable) << i << " swing " << s.swing_m;
    EXPECT_EQ(s.bounces, 0) << i;
    active += s.verdict == ContactVerdict::kSlightlyActive ? 1 : 0;
    quiet += s.verdict == ContactVerdict::kQuiet ? 1 : 0;
  }
  EXPECT_GT(active, 40);
  EXPECT_GT(quiet, 40);
}

// The energy that the run notes against that of the true way, behind the encoders: within the bound in every run, and
// on the whole far below it.
TEST(ContactStability, TheEncodersErrorIsWithinItsBound) {
  Dice dice(12);
  double error_J = 0, allowed_J = 0;
  int touched = 0;
  for (int i = 0; i < 400; ++i) {
    Trial run;
    run.stiffness_N_per_m = dice.decades(10, 20000);
    run.damping_Ns_per_m = dice.between(0, 2);
    run.rate_hz = dice.decades(500, 20000);
    run.seconds = 1;
    run.device.hand = i % 2 == 0 ? Hand::kRigid : Hand::kSpring;
    run.device.encoder_resolution_m = dice.decades(0.1e-6, 50e-6);
    const double deep_m = dice.between(0.1e-3, 1e-3);
    run.path = [=](double t_s) { return Vec3(0, 0, 0.5e-3 - (0.5e-3 + deep_m) * std::sin(M_PI * t_s)); };
    std::vector<Vec3> true_W;
    const std::vector<TickRecord> records = recordsOf(run, &true_W);
    double true_J = 0;
    for (std::size_t k = 1; k < true_W.size(); ++k)
      true_J -= Vec3(records[k - 1].force_W[0], records[k - 1].force_W[1], records[k - 1].force_W[2])
                    .dot(true_W[k] - true_W[k - 1]);
    const double found_J = records[true_W.size() - 1].energy_J;
    const ContactStability s = assessContact(records, {.resolution_m = run.device.encoder_resolution_m});
    touched += s.stored_J > 0 ? 1 : 0;
    EXPECT_LE(std::abs(found_J - true_J), s.allowed_J) << i;
    error_J += std::abs(found_J - true_J);
    allowed_J += s.allowed_J;
  }
  EXPECT_GT(touched, 350);
  EXPECT_LT(error_J, 0.1 * allowed_J);
}

// A spring hand that stable contact lets come to rest, tapping by itself, shaking, and sliding over a texture and over
// edges: none of it is the surface's doing.
TEST(ContactStability, WhatPathOrSurfaceAskForIsNotUnstable) {
  Dice dice(13);
  int stable = 0;
  const int trials = isLongRun() ? 900 : 300;
  for (int i = 0; i < trials; ++i) {
    Trial run;
    run.stiffness_N_per_m = dice.decades(50, 20000);
    run.damping_Ns_per_m = dice.between(0, 5);
    run.rate_hz = dice.decades(500, 20000);
    run.seconds = 4;
    run.device.hand = Hand::kSpring;
    run.device.encoder_resolution_m = dice.coin() ? 0 : dice.between(0, 50e-6);
    // A texture may meet the contact's resonance, which makes its height up to pi / (loss a period) times as large.
    if (!settles(run, i % 3 == 1 ? 1.2 * M_PI / SwingWatch::kUnasked : kLoss)) continue;
    ++stable;
    const double rate_hz = dice.decades(0.5, 8), deep_m = dice.between(0.3e-3, 2e-3);
    const double tap_m = i % 3 == 0 ? dice.between(1, 5) * deep_m : dice.between(0, 0.5) * deep_m;
    if (i % 3 == 1) {
      const double length_m = dice.between(0.3e-3, 4e-3), amplitude_m = dice.between(0.005, 0.045) * length_m;
      run.ground.height = [=](double x_m) { return amplitude_m * std::sin(2 * M_PI * x_m / length_m); };
    } else if (i % 3 == 2) {
      run.ground.height = [](double x_m) { return std::fmod(x_m, 4e-3) > 2e-3 ? -20e-3 : 0; };
    }
    const double slide_m_per_s = i % 3 == 0 ? 0 : dice.between(2e-3, 30e-3);
    run.path = [=](double t_s) {
      const double down = std::clamp(t_s / 0.3, 0.0, 1.0);
      const double tap = t_s < 0.3 ? 0 : tap_m * (1 - std::cos(2 * M_PI * rate_hz * (t_s - 0.3))) / 2;
      return Vec3(slide_m_per_s * t_s, 0, 1e-3 - (1e-3 + deep_m) * down + tap);
    };
    const ContactStability s = assess(run);
    EXPECT_NE(s.verdict, ContactVerdict::kUnstable)
        << i << " K " << run.stiffness_N_per_m << " B " << run.damping_Ns_per_m << " rate " << run.rate_hz
        << " encoder " << run.device.encoder_resolution_m << " tap " << tap_m << " at " << rate_hz << " slide "
        << slide_m_per_s << " swing " << s.swing_m << " hz " << s.swing_hz << " from " << s.unstable_from_s
        << " bounces " << s.bounces;
  }
  EXPECT_GT(stable, trials / 4.5);
}

TEST(ContactStability, ARunWithoutContactHasNoVerdict) {
  Trial run;
  run.path = [](double) { return Vec3(0, 0, 1e-3); };
  const ContactStability s = assess(run);
  EXPECT_EQ(s.verdict, ContactVerdict::kNoContact);
  EXPECT_EQ(s.given_J, 0);
  EXPECT_EQ(s.stored_J, 0);
  EXPECT_EQ(s.unstable_from_s, -1);
  EXPECT_EQ(assessContact({}, {}).verdict, ContactVerdict::kNoContact);
  EXPECT_EQ(assessContact({}, {.delay_ticks = 3}).delay_ticks, 3);
}

// ---- three of them ----

Trial stiff(double stiffness_N_per_m) {
  Trial run;
  run.stiffness_N_per_m = stiffness_N_per_m;
  run.device.hand = Hand::kSpring;
  run.path = press(1e-3);
  return run;
}

// K T / 2 = 5 N s/m, and T / 2 more behind the filter, against 3.1 of hand and device.
TEST(ContactStability, AStiffWallAtOneKilohertzIsUnstable) {
  const ContactStability s = assess(stiff(10000));
  EXPECT_EQ(s.verdict, ContactVerdict::kUnstable);
  EXPECT_GT(s.bounces, 30);
  EXPECT_GT(s.swing_m, 50e-6);
  EXPECT_GE(s.unstable_from_s, 0.1);  // it has touched by then
  EXPECT_LT(s.unstable_from_s, 0.5);
  EXPECT_GT(s.share, 0.1);
  // Bounces are at least as many as whole swings of the tool.
  EXPECT_GT(s.swing_hz, 5);
  EXPECT_LT(s.swing_hz, std::sqrt(10400 / 0.15) / (2 * M_PI));  // in contact all the time
}

// The same at 20 kHz, where sampling takes a twentieth, is none; nor is it at 500 N/m.
TEST(ContactStability, AFasterServoOrASofterWallIsNot) {
  Trial fast = stiff(10000);
  fast.rate_hz = 20000;
  EXPECT_LE(assess(fast).verdict, ContactVerdict::kSlightlyActive);
  EXPECT_LE(assess(stiff(500)).verdict, ContactVerdict::kSlightlyActive);
}

// A hand that nothing is known of, shaking at 40 Hz in contact, is not told from an instability; at 8 Hz it may be the
// hand.
TEST(ContactStability, WithoutAPathSlowSwingsAreTheHands) {
  Trial run = stiff(10000);
  run.path_known = false;
  EXPECT_EQ(assess(run).verdict, ContactVerdict::kUnstable);
  Trial hand;
  hand.damping_Ns_per_m = 0;
  hand.path_known = false;
  hand.path = [](double t_s) { return Vec3(0, 0, -1e-3 + 0.5e-3 * std::cos(2 * M_PI * 8 * t_s)); };
  EXPECT_EQ(assess(hand).verdict, ContactVerdict::kSlightlyActive);
}

// By hand: one contact that takes 2 mJ and gives 3, under encoders of 10 um and forces that change by 6 N in all.
TEST(ContactStability, CountsWhatTheWorstContactGave) {
  std::vector<TickRecord> records(9);
  const double force_N[] = {0, 1, 3, 1, 0, 0, 2, 0, 0}, energy_mJ[] = {5, 5, 7, 6, 4, 4, 4, 4.1, 4};
  for (std::size_t i = 0; i < records.size(); ++i) {
    records[i].tick = static_cast<std::int64_t>(i);
    records[i].force_W[1] = force_N[i];
    records[i].in_contact = force_N[i] > 0;
    records[i].energy_J = energy_mJ[i] * 1e-3;
  }
  const ContactStability s = assessContact(records, {.resolution_m = 10e-6});
  EXPECT_EQ(s.verdict, ContactVerdict::kSlightlyActive);
  EXPECT_NEAR(s.given_J, 1e-3, 1e-15);
  EXPECT_NEAR(s.stored_J, 2e-3, 1e-15);
  EXPECT_NEAR(s.share, 0.5, 1e-12);
  EXPECT_NEAR(s.error_J, 60e-6, 1e-15);
  EXPECT_NEAR(s.allowed_J, 2 * 0.01 * 2e-3 + 100e-6, 1e-11);
  // The device acts two ticks late: the last 4 mJ of the first contact come within its delay.
  records[5].energy_J = 3.5e-3;
  EXPECT_NEAR(assessContact(records, {.delay_ticks = 1}).given_J, 1.5e-3, 1e-15);
  EXPECT_NEAR(assessContact(records, {.delay_ticks = 0}).given_J, 1e-3, 1e-15);
  // What it gave is within 1 % of what it stored: quiet.
  for (std::size_t i = 4; i < records.size(); ++i) records[i].energy_J = 5e-3 - 19e-6;
  EXPECT_EQ(assessContact(records, {}).verdict, ContactVerdict::kQuiet);
  for (std::size_t i = 4; i < records.size(); ++i) records[i].energy_J = 5e-3 - 21e-6;
  EXPECT_EQ(assessContact(records, {}).verdict, ContactVerdict::kSlightlyActive);
  EXPECT_EQ(assessContact(records, {.resolution_m = 1e-6}).verdict, ContactVerdict::kQuiet);
}

// Where no contact gave more than its error, the figures are those of the one that gave most, not of the one that the
// encoders knew best.
TEST(ContactStability, QuietFiguresAreThoseOfTheContactThatGaveMost) {
  std::vector<TickRecord> records(7);
  const double force_N[] = {0, 0.01, 0, 0, 3, 0, 0}, energy_mJ[] = {0, 0, -1e-6, 0, 0, -20e-3, -20e-3};
  for (std::size_t i = 0; i < records.size(); ++i) {
    records[i].force_W[1] = force_N[i];
    records[i].energy_J = energy_mJ[i] * 1e-3;
  }
  const ContactStability s = assessContact(records, {.resolution_m = 10e-6});
  EXPECT_EQ(s.verdict, ContactVerdict::kQuiet);
  EXPECT_EQ(s.source, ActivitySource::kNone);
  EXPECT_NEAR(s.given_J, 20e-6, 1e-15);
  EXPECT_NEAR(s.error_J, 60e-6, 1e-15);
}

TEST(ContactStability, NamesWhereTheEnergyOfASlightlyActiveContactIsFrom) {
  std::vector<TickRecord> records(6);
  for (std::size_t i = 1; i < 4; ++i) records[i].force_W[1] = 1;
  for (std::size_t i = 2; i < 6; ++i) records[i].energy_J = -1e-3;
  for (TickRecord& r : records) r.edit_version = 7;
  EXPECT_EQ(assessContact(records, {}).source, ActivitySource::kField);
  EXPECT_EQ(assessContact(records, {.lacking_Ns_per_m = 0.1}).source, ActivitySource::kSampledWall);
  for (std::size_t i = 5; i < 6; ++i) records[i].edit_version = 8;  // after it
  EXPECT_EQ(assessContact(records, {.lacking_Ns_per_m = 0.1}).source, ActivitySource::kSampledWall);
  for (std::size_t i = 3; i < 6; ++i) records[i].edit_version = 8;
  EXPECT_EQ(assessContact(records, {.lacking_Ns_per_m = 0.1}).source, ActivitySource::kEdits);
  for (std::size_t i = 1; i < 6; ++i) records[i].edit_version = 8;  // it made the contact
  EXPECT_EQ(assessContact(records, {}).source, ActivitySource::kEdits);
}

// ---- the slew limit ----

// The force of a limited contact lags, which gives energy. What the default limit is derived from, walls of up to 5000
// N/m met at up to 0.8 m/s by anything from the bare device on, settles with it as it does without.
TEST(ContactStability, TheDefaultSlewLimitDoesNotShakeWhatADeviceCanRender) {
  Dice dice(17);
  int acted = 0, settled = 0;
  for (int i = 0; i < 900; ++i) {
    Trial run;
    run.stiffness_N_per_m = dice.decades(500, 5000);
    run.damping_Ns_per_m = dice.between(0, 5);
    run.rate_hz = dice.decades(500, 20000);
    run.seconds = 2;
    run.device.hand = Hand::kSpring;
    run.device.dynamics.hand_mass_kg = dice.decades(0.01, 0.3);
    run.device.dynamics.hand_damping_Ns_per_m = dice.decades(0.2, 6);
    const double speed_m_per_s = dice.decades(0.05, 0.8), depth_m = dice.between(0.5e-3, 20e-3);
    run.path = [=](double t_s) { return Vec3(0, 0, std::max(-depth_m, 20e-3 - speed_m_per_s * t_s)); };
    if (!settles(run)) continue;
    ++settled;
    run.slew_limit_N_per_s = SafetyParameters{}.slew_limit_N_per_s;
    const std::vector<TickRecord> records = recordsOf(run);
    const auto limited = [](const TickRecord& r) { return has(r.faults, ServoFault::kSlewLimited); };
    acted += std::any_of(records.begin(), records.end(), limited) ? 1 : 0;
    const WantedPath path(run.path);
    const ContactStability s = assessContact(records, {.path = &path});
    EXPECT_NE(s.verdict, ContactVerdict::kUnstable) << i << " K " << run.stiffness_N_per_m << " v " << speed_m_per_s;
  }
  EXPECT_GT(settled, 400);
  EXPECT_GT(acted, 50);
}

// It does not act at all on a spring of 5000 N/m that is met at 0.8 m/s, whose force rises by at most K v; on a jump of
// 8 N it does, at any rate.
TEST(ContactStability, TheDefaultSlewLimitActsOnJumpsNotOnTheStiffestWall) {
  for (const double rate_hz : {1000.0, 4000.0, 20000.0}) {
    Trial run;
    run.stiffness_N_per_m = 5000;
    run.damping_Ns_per_m = 0;
    run.rate_hz = rate_hz;
    run.slew_limit_N_per_s = SafetyParameters{}.slew_limit_N_per_s;
    run.path = [](double t_s) { return Vec3(0, 0, -1.5e-3 + std::abs(t_s - 1) * 0.799); };  // 7.5 N deep
    const std::vector<TickRecord> records = recordsOf(run);
    const auto limited = [](const TickRecord& r) { return has(r.faults, ServoFault::kSlewLimited); };
    EXPECT_FALSE(std::any_of(records.begin(), records.end(), limited)) << rate_hz;
    EXPECT_TRUE(std::any_of(records.begin(), records.end(), [](const TickRecord& r) { return r.force_W[2] > 7; }));
    SafetyGate gate(SafetyParameters{}, rate_hz);
    EXPECT_TRUE(has(gate.pass({{0, 0, 8}, 0, 0}).faults, ServoFault::kSlewLimited)) << rate_hz;
  }
}

// A limit far below K v, in a light hand: the contact that settles without it swings for ever, and is called what it
// is.
TEST(ContactStability, ASlewLimitFarTooLowShakesAndIsToldOf) {
  Trial run;
  run.stiffness_N_per_m = 4700;
  run.damping_Ns_per_m = 2;
  run.rate_hz = 3000;
  run.device.hand = Hand::kSpring;
  run.device.dynamics.hand_mass_kg = 0.01;
  run.device.dynamics.hand_damping_Ns_per_m = 0.3;
  run.path = [](double t_s) { return Vec3(0, 0, std::max(-12e-3, 20e-3 - 0.4 * t_s)); };
  EXPECT_NE(assess(run).verdict, ContactVerdict::kUnstable);
  run.slew_limit_N_per_s = 1000;
  EXPECT_EQ(assess(run).verdict, ContactVerdict::kUnstable);
}

}  // namespace contact_stability_test
}  // namespace palpate
