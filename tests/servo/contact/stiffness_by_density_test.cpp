// SPDX-License-Identifier: Apache-2.0
#include "servo/contact/stiffness_by_density.hpp"

#include <cmath>

#include <gtest/gtest.h>

#include "contact/plane_contact.hpp"
#include "servo/algorithms/hri.hpp"
#include "support/algorithm_driver.hpp"
#include "support/analytic_volume.hpp"

namespace palpate {
namespace {

constexpr double kVoxel = 1e-3;
constexpr double kDepth = 0.5e-3;
constexpr double kLevel = 30e-3;  // height of the surface, a sample

// Two materials side by side under one level surface: density rises from 0 at the surface to its plateau, 200 where
// x < 32 mm and 800 beyond, within a voxel and a half; outside it falls to -1000.
double twoMaterials(const Vec3& p) {
  const double inward_m = kLevel - p.z();
  const double plateau = p.x() < 32e-3 ? 200 : 800;
  return inward_m < 0 ? std::max(-1000.0, 1e6 * inward_m) : std::min(plateau, plateau * inward_m / (1.5 * kVoxel));
}

class StiffnessByDensityTest : public testing::Test {
 protected:
  StiffnessByDensityTest() { volume_.hold(held_, Vec3i::Zero(), volume_.size); }

  // VHIP - HIP for a tool kDepth under the surface point, by which the effect multiplied it.
  double factor(PlaneContact& contact, const Vec3& surface_W) {
    contact.window = &held_.window;
    contact.plane_T.p_W = surface_W;
    const Vec3 hip(surface_W - kDepth * Vec3::UnitZ());
    const Vec3 d = contact.at(hip) - hip;
    EXPECT_NEAR(std::hypot(d.x(), d.y()), 0, 1e-17);
    return d.z() / kDepth;
  }

  AnalyticVolume volume_ = millimetreVolume(twoMaterials, 64);
  HeldWindow held_;
  StiffnessByDensity effect_{StiffnessTable({{200, 0.25}, {800, 1.5}})};
};

// 2 voxels down the density is on the plateau; floats hold 200 and 800 exactly: the factors are the table's, but for
// the rounding of d, 1e-17 m of 0.5 mm.
TEST_F(StiffnessByDensityTest, EachMaterialHasItsOwn) {
  PlaneContact contact(effect_);
  EXPECT_NEAR(factor(contact, {20e-3, 30e-3, kLevel}), 0.25, 1e-12);
  EXPECT_NEAR(factor(contact, {40e-3, 30e-3, kLevel}), 1.5, 1e-12);
}

// Half of one and half of the other, half-way between the samples of two materials.
TEST_F(StiffnessByDensityTest, BetweenMaterialsItIsBetween) {
  PlaneContact contact(effect_);
  EXPECT_NEAR(factor(contact, {31.5e-3, 30e-3, kLevel}), 0.5 * (0.25 + 1.5), 1e-6);
}

// Whatever earlier effects made of d, its direction is kept: the friction cone too.
TEST_F(StiffnessByDensityTest, KeepsTheDirectionOfTheForce) {
  ContactState contact;
  contact.hip_W = Vec3(20e-3, 30e-3, kLevel - kDepth);
  contact.plane = {Vec3(20e-3, 30e-3, kLevel), Vec3::UnitZ(), 0};
  contact.new_contact = true;
  contact.window = &held_.window;
  const Vec3 d(0.2e-3, -0.1e-3, 0.4e-3);
  ContactPush push{contact.hip_W + d, 0.5 * d.z() * d.z()};
  effect_.move(contact, push);
  EXPECT_NEAR((push.vhip_W - contact.hip_W - 0.25 * d).norm(), 0, 1e-16);
  EXPECT_NEAR(push.energy_m2, 0.25 * 0.5 * d.z() * d.z(), 1e-16);
}

// Where nothing is known below the surface the contact's last factor holds; a new contact begins with 1.
TEST_F(StiffnessByDensityTest, BeyondTheWindowTheLastFactorHolds) {
  PlaneContact contact(effect_);
  ASSERT_NEAR(factor(contact, {20e-3, 30e-3, kLevel}), 0.25, 1e-12);
  EXPECT_NEAR(factor(contact, {20e-3, 30e-3, 1.5e-3}), 0.25, 1e-12);  // beyond the volume
  held_.window.version = 0;                                           // not usable
  EXPECT_NEAR(factor(contact, {40e-3, 30e-3, kLevel}), 0.25, 1e-12);
  contact.leave();
  EXPECT_NEAR(factor(contact, {40e-3, 30e-3, kLevel}), 1, 1e-12);
  held_.window.version = 2;
  EXPECT_NEAR(factor(contact, {40e-3, 30e-3, kLevel}), 1.5, 1e-12);
}

// With the algorithm: the forces on the two materials, equally deep, are as the factors, whatever K is.
TEST_F(StiffnessByDensityTest, ForcesOfTwoMaterialsAreAsTheirFactors) {
  const auto force_N = [&](double x_m) {
    ContactEffects effects;
    effects.push_back(std::make_unique<StiffnessByDensity>(StiffnessTable({{200, 0.25}, {800, 1.5}})));
    Hri hri(AlgorithmParameters{}, std::move(effects));
    AlgorithmDriver driver(hri, volume_, Vec3(x_m, 30e-3, kLevel + kDepth));
    driver.at(Vec3(x_m, 30e-3, kLevel + kDepth));
    TickOutput out;
    for (int i = 0; i < 20; ++i) out = driver.at(Vec3(x_m, 30e-3, kLevel - kDepth));
    EXPECT_TRUE(out.in_contact);
    return out.force_W.z();
  };
  // The surface found is within 0.02 voxel of z = 30 mm (surface_tracker.hpp), 4 % of the depth at most for each.
  EXPECT_NEAR(force_N(40e-3) / force_N(20e-3), 1.5 / 0.25, 6 * 0.08);
  EXPECT_NEAR(force_N(20e-3), 0.25 * 500 * kDepth, 0.04 * 0.25 * 500 * kDepth);
}

}  // namespace
}  // namespace palpate
