// SPDX-License-Identifier: Apache-2.0
#include "servo/algorithms/haptization.hpp"

#include <limits>

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
