// SPDX-License-Identifier: Apache-2.0
// Unstable contacts that the running servo notices and ends, and stable ones that it leaves alone.
#include "servo/loop/instability_guard.hpp"

#include <algorithm>
#include <cmath>

#include <gtest/gtest.h>

#include "base/error.hpp"
#include "servo/safety/faults.hpp"
#include "tests/support/long_run.hpp"
#include "wall_trials.hpp"

namespace palpate {
namespace instability_guard_test {

Trial anyWall(Dice& dice) {
  Trial run;
  run.guarded = true;
  run.path_known = false;
  run.rate_hz = dice.decades(100, 20000);
  run.stiffness_N_per_m = dice.decades(10, 1e6);
  run.damping_Ns_per_m = dice.coin() ? 0 : dice.decades(0.1, 50);
  run.device.hand = Hand::kSpring;
  run.device.dynamics = {.hand_mass_kg = dice.decades(0.02, 1),
                         .hand_damping_Ns_per_m = dice.decades(0.5, 20),
                         .hand_stiffness_N_per_m = dice.decades(100, 2000),
                         .device_mass_kg = dice.decades(0.01, 10),
                         .device_damping_Ns_per_m = dice.decades(0.05, 5)};
  run.device.delay_ticks = dice.coin() ? 0 : static_cast<int>(dice.between(0, 5));
  run.device.encoder_resolution_m = dice.coin() ? 0 : dice.decades(1e-6, 50e-6);
  run.seconds = 12;
  run.path = press(dice.between(0.3e-3, 3e-3));
  return run;
}

bool isUnstable(const TickRecord& record) {
  return has(record.faults, ServoFault::kUnstable);
}

// Without a force, hand and device are damped and come to rest. On the way there every force is within the limits.
void expectQuietEnd(const Trial& run, const std::vector<TickRecord>& records, int i) {
  const SafetyParameters safety;
  const double slew_N = run.slew_limit_N_per_s / run.rate_hz;
  Vec3 last_W = Vec3::Zero();
  for (const TickRecord& record : records) {
    const Vec3 force_W = asVec3(record.force_W);
    ASSERT_LE(force_W.norm(), safety.force_limit_N * (1 + 1e-12)) << i;  // NaN fails, too
    ASSERT_LE((force_W - last_W).norm(), slew_N * (1 + 1e-12)) << i;
    ASSERT_TRUE(std::isfinite(record.energy_J)) << i;
    last_W = force_W;
  }
  for (std::size_t k = records.size() * 9 / 10; k < records.size(); ++k) {
    ASSERT_TRUE(asVec3(records[k].force_W).isZero(0)) << i << " at " << records[k].time_s;
  }
}

// Ten touches with flights of up to a second are over within 12 s. Beyond that, a bounce that the surface feeds with
// less than 1 % of what it stores may go on.
TEST(InstabilityGuard, EndsContactsThatGrow) {
  Dice dice(21);
  int grown = 0, missed = 0;
  for (int i = 0; i < 900; ++i) {
    Trial run = anyWall(dice);
    if (i % 2 == 0) run.slew_limit_N_per_s = SafetyParameters{}.slew_limit_N_per_s;
    if (!grows(run)) continue;
    ++grown;
    const std::vector<TickRecord> records = recordsOf(run);
    const auto noticed = std::find_if(records.begin(), records.end(), isUnstable);
    if (noticed != records.end()) {
      expectQuietEnd(run, records, i);
    } else {
      ++missed;
    }
  }
  EXPECT_GT(grown, 200);
  EXPECT_LE(missed, grown / 100);
}

// The height of the tool over the last second, from the least to the most.
double lastSwing(const std::vector<TickRecord>& records, double rate_hz) {
  double least_m = 1, most_m = -1;
  for (auto r = records.end() - std::llround(rate_hz); r != records.end(); ++r) {
    least_m = std::min(least_m, r->hip_W[2]);
    most_m = std::max(most_m, r->hip_W[2]);
  }
  return most_m - least_m;
}

// Slower than any that count for their speed alone: a late force makes 1 to 11 Hz. They grow by 6 to 25 % a period, and
// the tool is pressed so gently and so deep that it takes twelve such periods from a swing that is felt to the surface.
TEST(InstabilityGuard, EndsSlowContactsThatGrow) {
  Dice dice(27);
  int grown = 0;
  for (int i = 0; i < 4000 && grown < (isLongRun() ? 200 : 40); ++i) {
    Trial run = anyWall(dice);
    run.rate_hz = 1000;
    run.stiffness_N_per_m = dice.decades(50, 1000);
    run.device.delay_ticks = static_cast<int>(dice.between(10, 60));
    run.device.encoder_resolution_m = 0;
    run.doubtful = false;
    run.seconds = 25;
    run.path = [](double t_s) { return Vec3(0, 0, 0.1e-3 - 10e-3 * (1 - std::cos(M_PI * std::min(t_s / 5, 1.0)))); };
    const Mode mode = fastestMode(run, 1);
    const double by_period = std::exp(mode.growth_per_s / mode.hz);
    if (!(mode.hz > 1) || mode.hz > 11 || by_period < 1.06 || by_period > 1.25) continue;
    const double hand_N_per_m = run.device.dynamics.hand_stiffness_N_per_m;
    const double kept_m = 20e-3 * hand_N_per_m / (hand_N_per_m + run.stiffness_N_per_m);
    if (kept_m < SwingWatch::leastFelt(mode.hz) * std::pow(by_period, 12)) continue;
    Trial left = run;
    left.guarded = false;
    if (lastSwing(recordsOf(left), run.rate_hz) < SwingWatch::leastFelt(mode.hz)) continue;
    ++grown;
    const std::vector<TickRecord> records = recordsOf(run);
    const auto noticed = std::find_if(records.begin(), records.end(), isUnstable);
    ASSERT_NE(noticed, records.end()) << i << ", " << mode.hz << " Hz, " << by_period;
    EXPECT_LE(lastSwing({records.begin(), noticed}, run.rate_hz), 1.2 * kept_m) << i;
    expectQuietEnd(run, records, i);
  }
  EXPECT_GE(grown, 20);
}

// A contact that settles swings as its path does, or less and less. Such a wall is known to be stable. Encoders must
// leave the force within its limit: the eigenvalues know of none.
TEST(InstabilityGuard, LeavesContactsThatSettle) {
  Dice dice(22);
  int settled = 0;
  const int trials = isLongRun() ? 900 : 300;
  for (int i = 0; i < trials; ++i) {
    Trial run = anyWall(dice);
    if (!settles(run) || run.stiffness_N_per_m * run.device.encoder_resolution_m > 1) continue;
    ++settled;
    run.doubtful = false;
    const std::vector<TickRecord> records = recordsOf(run);
    EXPECT_EQ(std::find_if(records.begin(), records.end(), isUnstable), records.end()) << i;
  }
  EXPECT_GT(settled, trials / 3);
}

// On a wall that is known to be stable, no tapping counts, however active the wall.
TEST(InstabilityGuard, LeavesATappingHandOnAWallThatIsKnownToBeStable) {
  Dice dice(23);
  int settled = 0, would_end = 0;
  const int trials = isLongRun() ? 600 : 200;
  for (int i = 0; i < trials; ++i) {
    Trial run = anyWall(dice);
    run.seconds = 4;
    const double hz = dice.between(1, 8), deep_m = dice.between(0.5e-3, 5e-3), high = dice.between(0, 1);
    run.path = [=](double t_s) { return Vec3(0, 0, deep_m * (high - std::sin(2 * M_PI * hz * t_s))); };
    if (!settles(run) || run.stiffness_N_per_m * run.device.encoder_resolution_m > 1) continue;
    ++settled;
    run.doubtful = false;
    const std::vector<TickRecord> records = recordsOf(run);
    EXPECT_EQ(std::find_if(records.begin(), records.end(), isUnstable), records.end()) << i;
    run.doubtful = true;
    const std::vector<TickRecord> doubted = recordsOf(run);
    would_end += std::any_of(doubted.begin(), doubted.end(), isUnstable) ? 1 : 0;
  }
  EXPECT_GT(settled, trials / 3);
  EXPECT_GT(would_end, trials / 60);
}

// How soon: 20 swings, in ticks, after the first of them begins; the swings' own frequency says how long that is.
TEST(InstabilityGuard, NoticesFastSwingsWithinTheTicksThatItStates) {
  Dice dice(24);
  int fast = 0;
  for (int i = 0; i < 600; ++i) {
    Trial run = anyWall(dice);
    run.doubtful = false;
    if (!grows(run)) continue;
    const std::vector<TickRecord> records = recordsOf(run);
    const auto noticed = std::find_if(records.begin(), records.end(), isUnstable);
    if (noticed == records.end()) continue;
    SwingWatch watch(run.device.encoder_resolution_m);
    const auto seen = std::find_if(records.begin(), records.end(), [&](const TickRecord& r) { return watch.add(r); });
    if (watch.unstable().swing_hz < SwingWatch::kHand_hz) continue;
    ++fast;
    EXPECT_EQ(noticed - seen, 1) << i;
    const double most_ticks = SwingWatch::kSwings / (2 * SwingWatch::kHand_hz) * run.rate_hz + 1;
    // The last turn is seen once the tool is back from it by the least swing: within half a period of the swings.
    const double half_period = run.rate_hz / (2 * watch.unstable().swing_hz);
    EXPECT_LE(static_cast<double>(noticed->tick) - watch.unstable().from_s * run.rate_hz, most_ticks + half_period)
        << i;
  }
  EXPECT_GT(fast, 60);
}

// The hand leaves the wall every second and comes back. Each time the wall is a quarter as stiff, until it is stable.
TEST(InstabilityGuard, ComesBackSofterUntilTheContactIsQuiet) {
  Trial run;
  run.guarded = true;
  run.stiffness_N_per_m = 200000;  // some 23 times the bound of the default hand
  run.device.hand = Hand::kSpring;
  run.seconds = 24;
  run.path = [](double t_s) {
    const double phase = std::fmod(t_s, 4.0);
    return Vec3(0, 0, phase < 2 ? -1e-3 : 5e-3);
  };
  const std::vector<TickRecord> records = recordsOf(run);
  std::vector<double> begun_s;
  for (std::size_t i = 1; i < records.size(); ++i) {
    if (isUnstable(records[i]) && !isUnstable(records[i - 1])) begun_s.push_back(records[i].time_s);
  }
  const double bound = stiffnessBound({.hand = run.device.dynamics}, run.damping_Ns_per_m);
  const int rounds = static_cast<int>(std::ceil(std::log(run.stiffness_N_per_m / bound) / std::log(4)));
  ASSERT_EQ(begun_s.size(), static_cast<std::size_t>(rounds));
  for (std::size_t i = 0; i < begun_s.size(); ++i) EXPECT_NEAR(begun_s[i], 4.0 * static_cast<double>(i), 1.0);
  // In the last press the wall is felt: K / 4^rounds in series with the hand, pressed 1 mm.
  const double felt = run.stiffness_N_per_m / std::pow(4, rounds), hand = run.device.dynamics.hand_stiffness_N_per_m;
  const TickRecord& last_press = records[static_cast<std::size_t>(21.9 * run.rate_hz)];
  EXPECT_NEAR(last_press.force_W[2], 1e-3 * felt * hand / (felt + hand), 1e-3);
}

TEST(InstabilityGuard, StaysAwayAsLongAsTheToolIsAtTheSurface) {
  Trial run;
  run.guarded = true;
  run.stiffness_N_per_m = 200000;
  run.device.hand = Hand::kSpring;
  run.seconds = 6;
  run.path = press(1e-3);
  const std::vector<TickRecord> records = recordsOf(run);
  const auto noticed = std::find_if(records.begin(), records.end(), isUnstable);
  ASSERT_NE(noticed, records.end());
  EXPECT_TRUE(std::all_of(noticed, records.end(), isUnstable));
  // The report calls it unstable, although its path alone would not show it any more.
  const WantedPath path(run.path);
  const ContactStability judged = assessContact(records, {.path = &path});
  EXPECT_EQ(judged.verdict, ContactVerdict::kUnstable);
  EXPECT_EQ(judged.ended_by_servo, 1);
  EXPECT_NEAR(judged.unstable_to_s, noticed->time_s, 0.05);
  // Off within the fade time of 0.1 s, and one tick for the fault itself.
  for (auto r = noticed + 101; r != records.end(); ++r) ASSERT_TRUE(asVec3(r->force_W).isZero(0)) << r->time_s;
}

TEST(InstabilityGuard, DoesNotActOnADeviceThatNoForceMoves) {
  Trial run;
  run.guarded = true;
  run.stiffness_N_per_m = 20000;
  run.path = [](double t_s) { return Vec3(0, 0, 0.2e-3 * std::sin(2 * M_PI * 40 * t_s)); };
  const std::vector<TickRecord> rigid = recordsOf(run);
  EXPECT_TRUE(std::none_of(rigid.begin(), rigid.end(), isUnstable));
}

// What is kept away stays so until the tool has been away, whatever the settings.
TEST(InstabilityGuard, NewSettingsHaveTheWholeForceOnceTheToolHasBeenAway) {
  InstabilityGuard guard({.away_s = 0.01}, {}, 1000);
  TickRecord record;
  for (int i = 0; guard.faults() == 0 && i < 1000; ++i) {
    record.time_s = i * 1e-3;
    record.hip_W[2] = i % 10 < 5 ? -1e-3 : 1e-3;
    record.in_contact = i % 10 < 5;
    record.normal_W[2] = record.in_contact ? 1 : 0;
    record.vhip_W[2] = record.in_contact ? 0 : record.hip_W[2];
    record.depth_m = record.in_contact ? 1e-3 : 0;
    record.force_W[2] = record.in_contact ? 1 : 0;
    record.energy_J = -1e-6 * i;
    guard.add(record);
  }
  EXPECT_EQ(guard.faults(), bit(ServoFault::kUnstable));
  EXPECT_EQ(guard.share(), 0.25);
  guard.takeNew(false);
  EXPECT_EQ(guard.share(), 1);
  EXPECT_EQ(guard.faults(), bit(ServoFault::kUnstable));
  record.faults = bit(ServoFault::kUnstable);
  record.in_contact = true;
  for (int i = 0; i < 100; ++i) guard.add(record);
  EXPECT_EQ(guard.faults(), bit(ServoFault::kUnstable));
  record.in_contact = false;
  for (int i = 0; i <= 10; ++i) guard.add(record);
  EXPECT_EQ(guard.faults(), 0U);
  EXPECT_EQ(guard.share(), 1);
}

TEST(InstabilityGuard, RefusesTimesAndSharesOutOfRange) {
  for (const double away_s : {-1.0, 61.0, std::nan("")})
    EXPECT_THROW(InstabilityGuard({.away_s = away_s}, {}, 1000), Error) << away_s;
  for (const double softer : {0.0, 1.0, -1.0, std::nan("")})
    EXPECT_THROW(InstabilityGuard({.softer = softer}, {}, 1000), Error) << softer;
}

}  // namespace instability_guard_test
}  // namespace palpate
