// SPDX-License-Identifier: Apache-2.0
// Contact effects work with every algorithm that has a VHIP, and are refused by every one that has none.
#include <gtest/gtest.h>

#include "base/error.hpp"
#include "servo/contact/effects.hpp"
#include "support/algorithm_driver.hpp"
#include "support/algorithm_setups.hpp"

namespace palpate {
namespace every_algorithm_test {

const std::string_view kWithoutVhip[] = {"avila", "haptization"};

bool hasVhip(std::string_view name) {
  return std::find(std::begin(kWithoutVhip), std::end(kWithoutVhip), name) == std::end(kWithoutVhip);
}

AnalyticVolume flat() {
  return millimetreVolume([](const Vec3& p_W) { return 20.3e-3 - p_W.z(); }, 40);
}

AlgorithmSetup withEffects(std::string_view name, const AnalyticVolume& volume, const EffectParameters& effects) {
  AlgorithmSetup setup = setupFor(name, {.damping_Ns_per_m = 0, .plane_renewal_ticks = 3}, volume, 4e-3);
  setup.effects = makeContactEffects(effects, setup.parameters.stiffness_N_per_m, 1000);
  return setup;
}

// A slide 1 mm deep on a plane: in steady slip the force along the plane is mu_d times the force across it, against the
// motion. The plane is exact but for float samples of up to 4e-2 m, 1e-6 of the depth; a god-object stands 1e-3 of the
// depth in front of its mesh, which adds as much to both.
TEST(EffectsOnEveryAlgorithm, FrictionIsTheSameCone) {
  const AnalyticVolume volume = flat();
  std::size_t algorithms_seen = 0;
  for (const AlgorithmEntry& entry : algorithms()) {
    if (!hasVhip(entry.name)) continue;
    SCOPED_TRACE(std::string(entry.name));
    const auto algorithm = makeAlgorithm(
        entry.name, withEffects(entry.name, volume, {.friction = {.static_ratio = 0.5, .dynamic_ratio = 0.3}}));
    AlgorithmDriver driver(*algorithm, volume, Vec3(15e-3, 20e-3, 21e-3), 40);
    driver.follow = false;
    driver.at(Vec3(15e-3, 20e-3, 21e-3));
    driver.stroke(Vec3(15e-3, 20e-3, 19.3e-3), 17);
    const TickOutput out = driver.stroke(Vec3(23e-3, 20e-3, 19.3e-3), 80).back();
    ASSERT_TRUE(out.in_contact);
    EXPECT_NEAR(out.force_W.z(), 0.5, 0.5 * 2e-3);
    EXPECT_NEAR(out.force_W.x(), -0.3 * out.force_W.z(), 1e-3 * out.force_W.z());
    EXPECT_NEAR(out.force_W.y(), 0, 1e-6);
    EXPECT_NEAR(out.depth_m, 1e-3, 2e-6);  // below the surface, wherever friction holds the VHIP
    EXPECT_LT((out.normal_W - Vec3::UnitZ()).norm(), 1e-6);
    const TickOutput free = driver.at(Vec3(23e-3, 20e-3, 21e-3));
    EXPECT_EQ(free.depth_m, 0);
    EXPECT_TRUE(free.normal_W.isZero(0));
    ++algorithms_seen;
  }
  EXPECT_EQ(algorithms_seen, algorithms().size() - std::size(kWithoutVhip));
}

// A layer is put over a sliding tool: friction goes by the force that is felt, so it stays in its cone all the time
// that the layer is taken in, and recovery time only makes that longer. At the end all is there. The paper's modes do
// not ease edits: there recovery time alone takes the layer in. The god-object's mesh is made once.
TEST(EffectsOnEveryAlgorithm, ALayerThatAnEditAddsIsTakenInWithThem) {
  const AnalyticVolume volume = flat();
  const AnalyticVolume after = millimetreVolume([](const Vec3& p_W) { return 22.3e-3 - p_W.z(); }, 40);
  for (const AlgorithmEntry& entry : algorithms()) {
    if (!hasVhip(entry.name) || entry.needs.isosurface_mesh) continue;
    SCOPED_TRACE(std::string(entry.name));
    const auto algorithm = makeAlgorithm(
        entry.name,
        withEffects(entry.name, volume, {.recovery_s = 0.02, .friction = {.static_ratio = 0.3, .dynamic_ratio = 0.3}}));
    AlgorithmDriver driver(*algorithm, volume, Vec3(15e-3, 20e-3, 21e-3), 40);
    driver.follow = false;
    driver.at(Vec3(15e-3, 20e-3, 21e-3));
    driver.stroke(Vec3(15e-3, 20e-3, 19.3e-3), 17);
    double last_N = driver.stroke(Vec3(17e-3, 20e-3, 19.3e-3), 80).back().force_W.z();
    EXPECT_NEAR(last_N, 0.5, 1e-3);
    driver.edit(after);
    const double taken_in_ticks = entry.name.starts_with("hri-paper") ? 20 : 500;
    TickOutput out;
    for (int i = 0; i < 600; ++i) {
      out = driver.at(Vec3(17e-3 + 10e-6 * i, 20e-3, 19.3e-3));
      ASSERT_TRUE(out.in_contact) << i;
      // K 2 mm / 500 a tick, or / 20, and what two planes of one surface differ by.
      ASSERT_LE(out.force_W.z() - last_N, 500 * 2e-3 / taken_in_ticks + 500 * 0.02e-3) << i;
      ASSERT_LE(out.force_W.head<2>().norm(), 0.3 * out.force_W.z() + 1e-6) << i;
      last_N = out.force_W.z();
    }
    EXPECT_NEAR(out.force_W.z(), 1.5, 2e-3);
    EXPECT_NEAR(out.force_W.x(), -0.3 * 1.5, 2e-3);
  }
}

// Below the surface the density says how stiff: twice K at 2.5 voxels below, where it is 2.5e-3.
TEST(EffectsOnEveryAlgorithm, StiffnessByDensityIsTheSameFactor) {
  const AnalyticVolume volume = flat();
  for (const AlgorithmEntry& entry : algorithms()) {
    if (!hasVhip(entry.name)) continue;
    SCOPED_TRACE(std::string(entry.name));
    const auto algorithm = makeAlgorithm(
        entry.name, withEffects(entry.name, volume, {.stiffness_by_density = {{0.5e-3, 1}, {2.5e-3, 2}, {4.5e-3, 3}}}));
    AlgorithmDriver driver(*algorithm, volume, Vec3(15e-3, 20e-3, 21e-3), 40);
    driver.follow = false;
    driver.at(Vec3(15e-3, 20e-3, 21e-3));
    const TickOutput out = driver.stroke(Vec3(15e-3, 20e-3, 19.3e-3), 17).back();
    ASSERT_TRUE(out.in_contact);
    EXPECT_NEAR(out.force_W.z(), 1.0, 1.0 * 2e-3);
  }
}

TEST(EffectsOnEveryAlgorithm, WhatHasNoVhipRefusesThem) {
  const AnalyticVolume volume = flat();
  for (const std::string_view name : kWithoutVhip) {
    EXPECT_THROW(static_cast<void>(makeAlgorithm(name, withEffects(name, volume, {.force_shading = true}))), Error);
  }
}

}  // namespace every_algorithm_test
}  // namespace palpate
