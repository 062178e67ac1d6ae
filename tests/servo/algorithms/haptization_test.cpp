// SPDX-License-Identifier: Apache-2.0
#include "servo/algorithms/haptization.hpp"

#include <cmath>
#include <limits>
#include <utility>

#include <gtest/gtest.h>

#include "base/error.hpp"
#include "servo/algorithms/registry.hpp"
#include "servo/safety/faults.hpp"
#include "support/algorithm_driver.hpp"

namespace palpate {
namespace haptization_test {

// Density 100 per mm below z = 20 mm, and flat from 5 mm below on.
AnalyticVolume ramp() {
  return millimetreVolume([](const Vec3& p_W) { return 1e5 * std::clamp(20e-3 - p_W.z(), -5e-3, 5e-3); }, 40);
}
Vec3 at(double depth_m) {
  return {20e-3, 20e-3, 20e-3 - depth_m};
}
// 0.01 N per unit of density above 0, to 4 N; viscosity from 0 to 8 N s/m; weight 1/2 at 1e5 per metre.
const TransferTables kTables{{{0, 0, 0}, {400, 4, 8}}, {{0, 0}, {2e5, 1}}};

class HaptizationRamp : public testing::Test {
 protected:
  HaptizationRamp() { driver.follow = false; }
  AnalyticVolume volume = ramp();
  Haptization haptization{{}, kTables};
  AlgorithmDriver driver{haptization, volume, at(1e-3), 40};
};

// Floats of up to 500 in density and 1e5 in gradient: relative errors of some 1e-7 each, so 1e-6 of a few newtons.
TEST_F(HaptizationRamp, ForceAndViscosityAreThoseOfTheTables) {
  driver.at(at(2e-3));
  TickOutput out = driver.at(at(2e-3));  // at rest
  EXPECT_LT((out.force_W - Vec3(0, 0, 0.5 * 2)).norm(), 1e-5);
  EXPECT_LT((out.normal_W - Vec3::UnitZ()).norm(), 1e-6);
  EXPECT_TRUE(out.in_contact);
  EXPECT_EQ(out.vhip_W, at(2e-3));  // there is no VHIP
  EXPECT_TRUE(std::isnan(out.depth_m));
  EXPECT_FALSE(out.at_surface);
  EXPECT_EQ(out.faults, 0u);
  out = driver.at(at(2e-3) + Vec3(0.5e-3, 0, 0));  // 0.5 m/s against 4 N s/m
  EXPECT_LT((out.force_W - Vec3(-2, 0, 1)).norm(), 1e-5);
}

TEST_F(HaptizationRamp, AFlatRegionIsViscousOnly) {
  driver.at(at(10e-3));
  const TickOutput out = driver.at(at(10e-3) + Vec3(0, 0.1e-3, 0));
  EXPECT_LT((out.force_W - Vec3(0, -0.8, 0)).norm(), 1e-5);
  EXPECT_FALSE(out.in_contact);
  EXPECT_TRUE(out.normal_W.isZero(0));
  EXPECT_EQ(out.depth_m, 0);
  EXPECT_EQ(out.faults, 0u);
}

// Flat and dense where nothing was: 8 N s/m against 0.1 m/s, a 500th of it more each tick; thinned out it is gone at
// once.
TEST_F(HaptizationRamp, ViscosityThatAnEditAddsComesInEvenly) {
  const AnalyticVolume nothing = millimetreVolume([](const Vec3&) { return -500.0; }, 40);
  const AnalyticVolume dense = millimetreVolume([](const Vec3&) { return 500.0; }, 40);
  AlgorithmDriver moving(haptization, nothing, at(10e-3), 40);
  moving.follow = false;
  const Vec3 way_W(0, 0.1e-3, 0);
  EXPECT_TRUE(moving.at(at(10e-3)).force_W.isZero(0));
  EXPECT_TRUE(moving.at(at(10e-3) + way_W).force_W.isZero(0));
  moving.edit(dense);
  for (int tick = 1; tick <= 500; ++tick) {
    const TickOutput out = moving.at(at(10e-3) + (tick % 2 == 0 ? way_W : Vec3(Vec3::Zero())));
    ASSERT_NEAR(out.force_W.norm(), 0.8 * tick / 500, 1e-5) << tick;
  }
  moving.edit(nothing);
  EXPECT_TRUE(moving.at(at(10e-3)).force_W.isZero(0));
}

// The tool goes a millimetre deeper in the tick in which a window of a new edit comes. The edit changed nothing here,
// so all of the force and the viscosity is felt at once: 1 N, and 4 N s/m against 1 m/s.
TEST_F(HaptizationRamp, TheToolsOwnMotionDuringAnEditIsNotEased) {
  driver.at(at(1e-3));
  driver.edit(volume);
  EXPECT_LT((driver.at(at(2e-3)).force_W - Vec3(0, 0, 1 + 4)).norm(), 1e-5);
}

// The new window does not hold the place of the last tick, so what was felt there, 0.5 N and 2 N s/m, is compared with
// what is felt now, 1 N and 4 N s/m: a 500th of the rise is felt. The tool has come at 10 m/s along x and 1 m/s down.
TEST_F(HaptizationRamp, AnEditIsComparedHereWhereTheWindowHasLeftTheLastPlace) {
  AlgorithmDriver leaping(haptization, volume, at(1e-3), 12);
  leaping.at(at(1e-3));
  const Vec3 force_W = leaping.leapWithEdit(at(2e-3) + Vec3(10e-3, 0, 0)).force_W;
  const double force_N = 0.5 + 0.5 / 500, viscosity_Ns_per_m = 2 + 2.0 / 500;
  EXPECT_LT((force_W - Vec3(-10 * viscosity_Ns_per_m, 0, force_N + viscosity_Ns_per_m)).norm(), 1e-4);
}

// In the last tick there was no window, so nothing was shown that the force could go on from.
TEST_F(HaptizationRamp, AnEditAfterAGapComesInFromNothing) {
  driver.at(at(1e-3));
  const std::uint64_t version = std::exchange(driver.window().version, 0);
  EXPECT_EQ(driver.at(at(1e-3)).faults, bit(ServoFault::kNoWindow));
  driver.window().version = version;
  driver.edit(volume);
  EXPECT_LT((driver.at(at(1e-3)).force_W - Vec3(0, 0, 0.5 / 500)).norm(), 1e-6);
}

// The edit turns the force of 0.5 N round. What was felt pushed the other way, so all of the new force comes in evenly.
TEST_F(HaptizationRamp, AForceThatAnEditTurnsRoundComesInEvenly) {
  const AnalyticVolume turned =
      millimetreVolume([](const Vec3& p_W) { return 1e5 * std::clamp(p_W.z() - 18e-3, -5e-3, 5e-3); }, 40);
  driver.at(at(1e-3));
  driver.edit(turned);
  for (const int tick : {1, 2}) EXPECT_LT((driver.at(at(1e-3)).force_W - Vec3(0, 0, -0.5 * tick / 500)).norm(), 1e-6);
}

// A force into the dense, 0.5 N down: an edit that changes nothing leaves it, one that adds it brings it in evenly.
TEST(Haptization, AForceIntoTheDenseIsEasedToo) {
  const AnalyticVolume volume = ramp();
  const AnalyticVolume nothing = millimetreVolume([](const Vec3&) { return -500.0; }, 40);
  Haptization haptization({}, {{{0, 0, 0}, {400, -4, 0}}, {{0, 0}, {2e5, 1}}});
  AlgorithmDriver driver(haptization, nothing, at(1e-3), 40);
  driver.follow = false;
  EXPECT_TRUE(driver.at(at(1e-3)).force_W.isZero(0));
  driver.edit(volume);
  for (int tick = 1; tick <= 500; ++tick)
    ASSERT_LT((driver.at(at(1e-3)).force_W - Vec3(0, 0, -0.5 * tick / 500)).norm(), 1e-6) << tick;
  driver.edit(volume);
  EXPECT_LT((driver.at(at(1e-3)).force_W - Vec3(0, 0, -0.5)).norm(), 1e-6);
}

TEST_F(HaptizationRamp, BelowTheTableAndBeyondTheVolumeThereIsNothing) {
  driver.at(at(-4e-3));
  for (const Vec3& p_W : {at(-3e-3), at(-0.1e-3), Vec3(-2e-3, 20e-3, 10e-3)}) {
    const TickOutput out = driver.at(p_W);
    EXPECT_TRUE(out.force_W.isZero(0));
    EXPECT_FALSE(out.in_contact);
    EXPECT_EQ(out.faults, 0u);
  }
}

TEST_F(HaptizationRamp, SamplesThatAreNotFiniteGiveNoForce) {
  HeldWindow held;
  volume.hold(held, Vec3i::Zero(), Vec3i::Constant(40), 9);
  for (const float bad : {std::numeric_limits<float>::quiet_NaN(), std::numeric_limits<float>::infinity()}) {
    for (Sample& s : held.samples) s = {bad, bad, bad, bad};
    ++held.window.version;
    TickOutput out;
    haptization.tick({at(1e-3), Vec3(1, 0, 0), &held.window}, out);
    EXPECT_TRUE(out.force_W.isZero(0));
  }
}

TEST(Haptization, NoForceWhereTheWindowDoesNotReach) {
  const AnalyticVolume volume = ramp();
  Haptization haptization({}, kTables);
  HeldWindow held;
  volume.hold(held, Vec3i::Constant(4), Vec3i::Constant(20));
  TickOutput out;
  haptization.tick({Vec3(30e-3, 20e-3, 10e-3), Vec3::Ones(), &held.window}, out);
  EXPECT_EQ(out.faults, bit(ServoFault::kBeyondWindow));
  EXPECT_TRUE(out.force_W.isZero(0));
  held.window.version = 0;
  haptization.tick({at(1e-3), Vec3::Ones(), &held.window}, out);
  EXPECT_EQ(out.faults, bit(ServoFault::kNoWindow));
  EXPECT_TRUE(out.force_W.isZero(0));
}

// Without tables: felt from the isosurface on.
TEST(Haptization, TheRegistryFillsInTheStandardTables) {
  const AnalyticVolume volume = ramp();
  AlgorithmSetup setup;
  setup.parameters.isovalue = 100;  // at 1 mm
  setup.scale = {400, 1e-3};
  const auto haptization = makeAlgorithm("haptization", std::move(setup));
  AlgorithmDriver driver(*haptization, volume, at(0), 40);
  driver.follow = false;
  EXPECT_TRUE(driver.at(at(0.9e-3)).force_W.isZero(0));
  driver.at(at(2e-3));
  EXPECT_LT((driver.at(at(2e-3)).force_W - Vec3(0, 0, 1.5)).norm(), 1e-5);
}

TEST(Haptization, TablesOfASceneReplaceTheStandardOnes) {
  const AnalyticVolume volume = ramp();
  AlgorithmSetup setup;
  setup.haptization.density = {{0, 0, 0}, {100, 1, 0}};
  setup.scale = {400, 1e-3};
  const auto haptization = makeAlgorithm("haptization", std::move(setup));
  AlgorithmDriver driver(*haptization, volume, at(2e-3), 40);
  EXPECT_LT((driver.at(at(2e-3)).force_W - Vec3(0, 0, 1)).norm(), 1e-5);
}

// A table of weights alone: the densities are the standard ones, 1.5 N at 2 mm, and a gradient of 1e5 weighs a quarter.
TEST(Haptization, ATableOfASceneMayLeaveTheOtherAtTheStandard) {
  const AnalyticVolume volume = ramp();
  AlgorithmSetup setup;
  setup.parameters.isovalue = 100;
  setup.haptization.gradient = {{0, 0}, {4e5, 1}};
  setup.scale = {400, 1e-3};
  const auto haptization = makeAlgorithm("haptization", std::move(setup));
  AlgorithmDriver driver(*haptization, volume, at(2e-3), 40);
  EXPECT_LT((driver.at(at(2e-3)).force_W - Vec3(0, 0, 1.5 / 4)).norm(), 1e-5);
}

class NoEffect final : public ContactEffect {
 public:
  void release() noexcept override {}
  void move(const ContactState&, ContactPush&) noexcept override {}
};

TEST(Haptization, RefusesEffectsAndBadTables) {
  AlgorithmSetup with_effects;
  with_effects.effects.push_back(std::make_unique<NoEffect>());
  EXPECT_THROW(static_cast<void>(makeAlgorithm("haptization", std::move(with_effects))), Error);
  AlgorithmSetup unsorted;
  unsorted.haptization.density = {{1, 0, 0}, {0, 0, 0}};
  EXPECT_THROW(static_cast<void>(makeAlgorithm("haptization", std::move(unsorted))), Error);
}

}  // namespace haptization_test
}  // namespace palpate
