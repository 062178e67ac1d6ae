// SPDX-License-Identifier: Apache-2.0
#include "servo/algorithms/avila.hpp"

#include <limits>

#include <gtest/gtest.h>

#include "base/error.hpp"
#include "servo/algorithms/registry.hpp"
#include "servo/safety/faults.hpp"
#include "support/algorithm_driver.hpp"

namespace palpate {
namespace avila_test {

// Density 200 per mm below z = 20 mm, flat from 6 mm below on: the linear estimate is the depth itself.
constexpr double kSurface = 20e-3;
AnalyticVolume ramp() {
  return millimetreVolume([](const Vec3& p_W) { return 2e5 * std::clamp(kSurface - p_W.z(), -6e-3, 6e-3); }, 40);
}
Vec3 at(double depth_m) {
  return {20e-3, 20e-3, kSurface - depth_m};
}

class AvilaRamp : public testing::Test {
 protected:
  AvilaRamp() { driver.follow = false; }
  AnalyticVolume volume = ramp();
  Avila avila{{0, 500, 2.0, 1}};
  AlgorithmDriver driver{avila, volume, at(1e-3), 40};
};

// Densities of up to 1200 as floats: 1e-4 of 2e5 per metre, so 4e-10 m and K times that.
TEST_F(AvilaRamp, PushesByTheDepthThatTheDensitySays) {
  for (double depth_m : {0.01e-3, 0.5e-3, 1e-3, 2.9e-3}) {
    driver.at(at(depth_m));
    const TickOutput out = driver.at(at(depth_m));  // at rest
    EXPECT_TRUE(out.in_contact);
    EXPECT_LT((out.force_W - Vec3(0, 0, 500 * depth_m)).norm(), 1e-6);
    EXPECT_NEAR(out.vhip_W.z(), kSurface, 1e-9);
    EXPECT_NEAR(out.depth_m, depth_m, 1e-9);
    EXPECT_LT((out.normal_W - Vec3::UnitZ()).norm(), 1e-6);
    EXPECT_EQ(out.faults, 0u);
    EXPECT_EQ(out.plane_age_ticks, 0);
  }
}

TEST_F(AvilaRamp, DepthCountsUpToItsCap) {
  driver.at(at(4.5e-3));
  EXPECT_LT((driver.at(at(4.5e-3)).force_W - Vec3(0, 0, 500 * 3e-3)).norm(), 1e-6);
}

// -B v with v = 1 mm a tick, that is 1 m/s; the force of the depth is known from above.
TEST_F(AvilaRamp, RetardsMotionInEveryDirectionAlsoOut) {
  driver.at(at(1e-3));
  EXPECT_LT((driver.at(at(1e-3) + Vec3(1e-3, 0, 0)).force_W - Vec3(-2.0, 0, 0.5)).norm(), 1e-6);
  driver.at(at(2e-3));
  EXPECT_LT((driver.at(at(1e-3)).force_W - Vec3(0, 0, 0.5 - 2.0)).norm(), 1e-6);
}

// The tool goes a millimetre deeper in the tick in which a window of a new edit comes. The edit changed nothing here,
// so all of the force is felt at once: 2 mm, and 1 m/s down.
TEST_F(AvilaRamp, TheToolsOwnMotionDuringAnEditIsNotEased) {
  driver.at(at(1e-3));
  driver.edit(volume);
  EXPECT_LT((driver.at(at(2e-3)).force_W - Vec3(0, 0, 500 * 2e-3 + 2.0)).norm(), 1e-6);
}

// The new window does not hold the place of the last tick, so the depth shown there, 1 mm, is compared with that here,
// 2 mm: a 500th of the rise is felt. The tool has come at 10 m/s along x and 1 m/s down.
TEST_F(AvilaRamp, AnEditIsComparedHereWhereTheWindowHasLeftTheLastPlace) {
  AlgorithmDriver leaping(avila, volume, at(1e-3), 12);
  leaping.at(at(1e-3));
  const Vec3 force_W = leaping.leapWithEdit(at(2e-3) + Vec3(10e-3, 0, 0)).force_W;
  EXPECT_LT((force_W - Vec3(-20, 0, 500 * (1e-3 + 1e-3 / 500) + 2)).norm(), 1e-6);
}

// The edit turns the normal round: what was felt pushed the other way, so all of the new force comes in evenly.
TEST_F(AvilaRamp, AForceThatAnEditTurnsRoundComesInEvenly) {
  const AnalyticVolume turned =
      millimetreVolume([](const Vec3& p_W) { return 2e5 * std::clamp(p_W.z() - 18e-3, -6e-3, 6e-3); }, 40);
  driver.at(at(1e-3));
  driver.edit(turned);
  for (const int tick : {1, 2})
    EXPECT_LT((driver.at(at(1e-3)).force_W - Vec3(0, 0, -500 * 1e-3 * tick / 500)).norm(), 1e-6);
}

TEST_F(AvilaRamp, OutsideThereIsNothing) {
  driver.at(at(-3e-3));
  for (double depth_m : {-2e-3, -1e-4, 0.0}) {
    const TickOutput out = driver.at(at(depth_m));
    EXPECT_FALSE(out.in_contact);
    EXPECT_TRUE(out.force_W.isZero(0));
    EXPECT_TRUE(out.normal_W.isZero(0));
    EXPECT_EQ(out.depth_m, 0);
    EXPECT_EQ(out.vhip_W, at(depth_m));
    EXPECT_EQ(out.faults, 0u);
  }
  EXPECT_EQ(driver.at(Vec3(-1e-3, 20e-3, 10e-3)).faults, 0u);  // beyond the volume
}

// The shell can be gone through: where the density is flat there is no force, however deep.
TEST_F(AvilaRamp, AFlatInsideIsAFaultAndNoForce) {
  const TickOutput out = driver.at(at(12e-3));
  EXPECT_EQ(out.faults, bit(ServoFault::kZeroGradient));
  EXPECT_TRUE(out.force_W.isZero(0));
  EXPECT_FALSE(out.in_contact);
}

TEST_F(AvilaRamp, SamplesThatAreNotFiniteGiveNoForce) {
  HeldWindow held;
  volume.hold(held, Vec3i::Zero(), Vec3i::Constant(40), 9);
  for (const float bad : {std::numeric_limits<float>::quiet_NaN(), std::numeric_limits<float>::infinity()}) {
    for (Sample& s : held.samples) s = {bad, bad, bad, bad};
    ++held.window.version;
    TickOutput out;
    avila.tick({at(1e-3), Vec3::Zero(), &held.window}, out);
    EXPECT_TRUE(out.force_W.isZero(0));
    EXPECT_FALSE(out.in_contact);
  }
}

TEST(Avila, BehindTheMiddleOfAThinWallItPushesOn) {
  const AnalyticVolume wall = millimetreVolume([](const Vec3& p_W) { return 4e-3 - std::abs(p_W.z() - kSurface); }, 40);
  Avila avila({0, 500, 0, 1});
  AlgorithmDriver driver(avila, wall, at(-6e-3), 40);
  driver.follow = false;
  EXPECT_GT(driver.at(at(-2e-3)).force_W.z(), 0);
  EXPECT_LT(driver.at(at(2e-3)).force_W.z(), 0);
}

TEST(Avila, NoForceWhereTheWindowDoesNotReach) {
  const AnalyticVolume volume = ramp();
  Avila avila(AlgorithmParameters{});
  HeldWindow held;
  volume.hold(held, Vec3i::Constant(4), Vec3i::Constant(20));
  TickOutput out;
  avila.tick({Vec3(30e-3, 20e-3, 10e-3), Vec3::Zero(), &held.window}, out);
  EXPECT_EQ(out.faults, bit(ServoFault::kBeyondWindow));
  EXPECT_TRUE(out.force_W.isZero(0));
  held.window.version = 0;
  avila.tick({at(1e-3), Vec3::Zero(), &held.window}, out);
  EXPECT_EQ(out.faults, bit(ServoFault::kNoWindow));
}

// A new window is used at once, and reset() forgets the old one though its number comes again.
TEST(Avila, ReadsTheNewestWindow) {
  const AnalyticVolume low = ramp();
  const AnalyticVolume high = millimetreVolume([](const Vec3& p_W) { return 2e5 * (22e-3 - p_W.z()); }, 40);
  Avila avila({0, 500, 0, 1});
  AlgorithmDriver driver(avila, high, at(1e-3), 40);
  driver.follow = false;
  EXPECT_NEAR(driver.at(at(0.5e-3)).force_W.z(), 1.25, 1e-6);
  driver.edit(low);
  EXPECT_NEAR(driver.at(at(0.5e-3)).force_W.z(), 0.25, 1e-6);
}

class NoEffect final : public ContactEffect {
 public:
  void release() noexcept override {}
  void move(const ContactState&, ContactPush&) noexcept override {}
};

TEST(Avila, RefusesContactEffects) {
  AlgorithmSetup setup;
  setup.effects.push_back(std::make_unique<NoEffect>());
  EXPECT_THROW(static_cast<void>(makeAlgorithm("avila", std::move(setup))), Error);
}

}  // namespace avila_test
}  // namespace palpate
