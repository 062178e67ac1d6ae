// SPDX-License-Identifier: Apache-2.0
#include "servo/contact/stiffness_by_density.hpp"

#include <cmath>

#include <gtest/gtest.h>

#include "contact/plane_contact.hpp"
#include "servo/algorithms/hri.hpp"
#include "support/algorithm_driver.hpp"
#include "support/analytic_volume.hpp"
#include "support/sampled_volume.hpp"

namespace palpate {
namespace stiffness_by_density_test {

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

  // What the effect multiplied d by, along the normal, for a tool kDepth under the surface point.
  double factor(PlaneContact& contact, const Vec3& surface_W) {
    contact.window = &held_.window;
    contact.plane_T.p_W = surface_W;
    const Vec3 hip(surface_W - kDepth * Vec3::UnitZ());
    const Vec3 d = contact.at(hip) - hip;
    EXPECT_NEAR(contact.push.energy_m2, 0.5 * kDepth * d.z(), 1e-19);
    return d.z() / kDepth;
  }

  AnalyticVolume volume_ = millimetreVolume(twoMaterials, 64);
  HeldWindow held_;
  StiffnessByDensity effect_{StiffnessTable({{200, 0.25}, {800, 1.5}}), 1000};
};

// 2.5 voxels down and 1.5 about that the density is on the plateau; floats hold 200 and 800 exactly: the factors are
// the table's, but for the rounding of d, 1e-17 m of 0.5 mm.
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
  FeltSurface felt(0, 1000);
  contact.felt = felt.feel({.hip_W = contact.hip_W, .plane = contact.plane, .begins = true, .window = &held_.window});
  const Vec3 d(0.2e-3, -0.1e-3, 0.4e-3);
  ContactPush push{.vhip_W = contact.hip_W + d, .surface_d_W = d, .energy_m2 = 0.5 * d.z() * d.z()};
  effect_.move(contact, push);
  EXPECT_NEAR((push.vhip_W - contact.hip_W - 0.25 * d).norm(), 0, 1e-16);
  EXPECT_NEAR(push.energy_m2, 0.25 * 0.5 * d.z() * d.z(), 1e-16);
}

// What is added to K is added along the felt normal. If force shading has turned d there already, it is not turned
// twice; what a texture laid over the surface is made stiffer with it.
TEST_F(StiffnessByDensityTest, TurnsNoShadedForceAgain) {
  ContactState contact;
  contact.hip_W = Vec3(40e-3, 30e-3, kLevel - kDepth);
  contact.plane = {Vec3(40e-3, 30e-3, kLevel), Vec3::UnitZ(), 0};
  contact.new_contact = true;
  FeltSurface felt(0, 1000);
  contact.felt = felt.feel({.hip_W = contact.hip_W, .plane = contact.plane, .begins = true, .window = &held_.window});
  contact.felt.normal_W = Vec3(0.6, 0, 0.8);
  contact.felt.now_W.z() -= 3 * kVoxel;  // the density there is on the plateau in every direction
  contact.felt.depth_m = 0.8 * kDepth;
  const Vec3 shaded_d = kDepth * Vec3(0.75, 0, 1), bump(0, 0.01e-3, 0.02e-3);
  ContactPush push{
      .vhip_W = contact.hip_W + shaded_d + bump, .surface_d_W = shaded_d, .energy_m2 = 0.5 * kDepth * kDepth};
  effect_.move(contact, push);
  const Vec3 wanted_d = shaded_d + bump + 0.5 * (0.8 * kDepth * Vec3(0.6, 0, 0.8) + bump);
  EXPECT_NEAR((push.vhip_W - contact.hip_W - wanted_d).norm(), 0, 1e-9 * kDepth);
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

// The factor rises by 4 a metre of density, which rises by 1 a metre along x: F = K f D N - K / 2 D^2 grad f, the last
// divided by 1 + D^2 / 2 b with b the bend at a border of the table's range of 2, everywhere and whatever the lattice.
// Samples are floats of some 0.1: 1e-8 of a metre, 4e-7 of the factor's slope over a voxel.
TEST(StiffnessByDensity, OnALevelSlopeTheForceIsTheClosedForm) {
  const Vec3 up = Vec3(0.2, -0.3, 0.9).normalized();
  const Vec3 along = (Vec3::UnitX() - up * up.x()).normalized();
  for (const int kind : {0, 1, 2}) {
    AnalyticVolume volume;
    if (kind > 0) {
      volume.lattice.spacing_m = Vec3(0.5e-3, 0.5e-3, 3e-3);
      volume.lattice.R_WL = someRotation();
    }
    if (kind == 2) volume.lattice.R_WL.col(1) *= -1;
    volume.size = Vec3i::Constant(40);
    volume.density = [&](const Vec3& p) { return along.dot(p); };
    HeldWindow held;
    volume.hold(held, Vec3i::Zero(), volume.size);
    const Vec3 middle = volume.lattice.toWorld(Vec3::Constant(19.6));
    const double there = along.dot(middle);
    StiffnessByDensity effect(StiffnessTable({{there - 0.25, 0}, {there + 0.25, 2}}), 1000);
    PlaneContact contact(effect);
    contact.window = &held.window;
    contact.plane_is_felt = true;
    contact.plane_T = {middle, up, 0};
    for (const double way_m : {-1e-3, 0.0, 0.7e-3}) {
      const Vec3 hip = middle + way_m * along - kDepth * up;
      const double factor = 1 + 4 * way_m;
      const double stored_m2 = 0.5 * kDepth * kDepth;
      const double bend_per_m2 = 2 * LatticeSpline::kBorderBend / std::pow(volume.lattice.smallestSpacing(), 2);
      const Vec3 d = factor * kDepth * up - stored_m2 / (1 + stored_m2 * bend_per_m2) * 4 * along;
      EXPECT_NEAR((contact.at(hip) - hip - d).norm(), 0, 1e-4 * 0.5 * kDepth * kDepth * 4 + 1e-6 * kDepth) << kind;
    }
  }
}

// Beside a border between two materials the tool is held along the surface by K at most, however deep it is and however
// the border lies.
TEST(StiffnessByDensity, HoldsTheToolAlongTheSurfaceByNoMoreThanTheStiffness) {
  Seeded random(15);
  double most = 0;
  for (int i = 0; i < 200; ++i) {
    const Vec3 across = random.direction();
    AnalyticVolume volume = millimetreVolume([&](const Vec3& p) { return across.dot(p) > 0 ? 1.0 : 0.0; }, 16);
    volume.lattice = latticeAround(random.inCube(0.5e-3), volume.size, Vec3::Constant(1e-3));
    HeldWindow held;
    volume.hold(held, Vec3i::Zero(), volume.size);
    StiffnessByDensity effect(StiffnessTable({{0, random.between(0, 1)}, {1, random.between(1, 10)}}), 1000);
    for (int j = 0; j < 30; ++j) {
      const Vec3 up = random.direction(), way = random.across(up);
      const Vec3 at_W = random.inCube(2e-3) + StiffnessByDensity::kBelow * 1e-3 * up;
      PlaneContact contact(effect);
      contact.plane_T = {at_W, up, 0};
      contact.window = &held.window;
      contact.plane_is_felt = true;
      const double q = 1e-9;
      const Vec3 hip = at_W - random.logBetween(0.05e-3, 10e-3) * up;
      const Vec3 change = contact.at(hip - q * way) - contact.at(hip + q * way) + 2 * q * way;
      const double stiffness = change.dot(way) / (2 * q);
      // The factor itself is of the normal alone: along the surface the plane gives no force.
      ASSERT_LE(stiffness, 1 + 1e-5) << i << " " << j;
      most = std::max(most, stiffness);
      contact.leave();
    }
  }
  EXPECT_GT(most, 0.3);
}

// How deep it looks is by how far a voxel blurs a border that lies so: 2.5 sides along an axis of the lattice.
TEST(StiffnessByDensity, LooksBeyondTheBlurOfVoxelsThatAreNotCubes) {
  AnalyticVolume volume;
  volume.lattice.spacing_m = Vec3(0.5e-3, 0.5e-3, 3e-3);
  volume.size = Vec3i(60, 60, 20);
  for (const int axis : {0, 2}) {
    const double side_m = volume.lattice.spacing_m[axis];
    const Vec3 middle = volume.lattice.toWorld(0.5 * volume.size.cast<double>());
    volume.density = [&](const Vec3& p) { return middle[axis] - p[axis]; };
    HeldWindow held;
    volume.hold(held, Vec3i::Zero(), volume.size);
    StiffnessByDensity effect(StiffnessTable({{0, 0}, {1, 100}}), 1000);
    PlaneContact contact(effect);
    contact.window = &held.window;
    contact.plane_T = {middle, Vec3::Unit(axis), 0};
    const Vec3 hip = middle - kDepth * Vec3::Unit(axis);
    EXPECT_NEAR((contact.at(hip) - hip)[axis] / kDepth, 100 * StiffnessByDensity::kBelow * side_m, 1e-5) << axis;
  }
}

// With the algorithm: the forces on the two materials, equally deep, are as the factors, whatever K is.
TEST_F(StiffnessByDensityTest, ForcesOfTwoMaterialsAreAsTheirFactors) {
  const auto force_N = [&](double x_m) {
    ContactEffects effects;
    effects.push_back(std::make_unique<StiffnessByDensity>(StiffnessTable({{200, 0.25}, {800, 1.5}}), 1000));
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

}  // namespace stiffness_by_density_test
}  // namespace palpate
