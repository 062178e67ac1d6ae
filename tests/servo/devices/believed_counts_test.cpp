// SPDX-License-Identifier: Apache-2.0
// Counts that a hand can have made, and counts that leap; polhem_slips_test.cpp has them over a whole device.
#include "servo/devices/believed_counts.hpp"

#include <gtest/gtest.h>

#include "support/seeded.hpp"

namespace palpate {
namespace believed_counts_test {

using Verdict = BelievedCounts::Verdict;

constexpr double kTick_s = 1e-3;
constexpr BelievedCounts::Interval kOneTick = {kTick_s, 0, 0};

const ArmKinematics& polhem() {
  static const ArmKinematics arm(
      {ArmJoint{}, ArmJoint{.body_m = 0.1, .length_m = 0.174}, ArmJoint{.body_m = 0.1, .length_m = 0.133}},
      Vec3(0.14, 0, 0.1));
  return arm;
}

PolhemCounts countsAt(const Vec3& angles) {
  const ArmCounts counts = polhem().countsAt(angles);
  PolhemCounts raw{};
  for (std::size_t k = 0; k < 3; ++k) raw[k] = static_cast<std::int16_t>(counts[k]);
  return raw;
}

const Vec3 kMiddle(0, 0.44, 0.52);

// At 0.2 m/s, where 16 bits end and begin anew at the other end.
TEST(BelievedCounts, FollowAHandBeyondSixteenBits) {
  BelievedCounts believed(polhem(), kTick_s);
  PolhemCounts raw{};
  raw[0] = 32'000;
  believed.countFrom(raw);
  for (int i = 0; i < 300; ++i) {
    raw[0] = static_cast<std::int16_t>(static_cast<std::uint16_t>(raw[0]) + 5U);
    ASSERT_EQ(believed.look(raw, kOneTick), Verdict::kMotion);
  }
  EXPECT_EQ(believed.counts()[0], 32'000 + 5 * 300);
  EXPECT_EQ(believed.raw(), raw);
}

// One that leaps changes nothing; the third in a row says that the arm counts from there.
TEST(BelievedCounts, TakeTheThirdLeapForAnotherPlace) {
  BelievedCounts believed(polhem(), kTick_s);
  const PolhemCounts here = countsAt(kMiddle), there = countsAt(kMiddle + Vec3(0, 0.2, 0));  // some 35 mm away
  believed.countFrom(here);
  for (int i = 0; i < 100; ++i) ASSERT_EQ(believed.look(here, kOneTick), Verdict::kMotion);
  const Vec3 at_A = believed.position_A();
  for (int round = 0; round < 3; ++round) {
    EXPECT_EQ(believed.look(there, kOneTick), Verdict::kLeap);
    EXPECT_EQ(believed.look(there, {2 * kTick_s, 0, 0}), Verdict::kLeap);
    EXPECT_EQ(believed.position_A(), at_A);
    EXPECT_EQ(believed.look(here, {3 * kTick_s, 0, 0}), Verdict::kMotion);  // as it was: none in a row any more
  }
  for (int leap = 1; leap <= BelievedCounts::kMostLeaps; ++leap) {
    EXPECT_EQ(believed.look(there, {leap * kTick_s, 0, 0}),
              leap < BelievedCounts::kMostLeaps ? Verdict::kLeap : Verdict::kElsewhere);
  }
  EXPECT_EQ(believed.raw(), there);
  EXPECT_NEAR((believed.position_A() - at_A).norm(), 0.035, 0.002);
  EXPECT_EQ(believed.look(there, kOneTick), Verdict::kMotion);
}

// Within 0.2 s of reports a hand goes 0.2 m. If the arm said nothing for nearly all of that time, its counts may have
// leapt as well.
TEST(BelievedCounts, BelieveASilenceLess) {
  const PolhemCounts here = countsAt(kMiddle), there = countsAt(kMiddle + Vec3(1.6, 0, 0));  // at a radius of 0.14 m
  for (const double silent_s : {0.0, 0.19}) {
    BelievedCounts believed(polhem(), kTick_s);
    believed.countFrom(here);
    for (int i = 0; i < 100; ++i) ASSERT_EQ(believed.look(here, kOneTick), Verdict::kMotion);
    EXPECT_EQ(believed.look(there, {0.2, 0, silent_s}), silent_s > 0 ? Verdict::kLeap : Verdict::kMotion) << silent_s;
  }
}

}  // namespace believed_counts_test
}  // namespace palpate
