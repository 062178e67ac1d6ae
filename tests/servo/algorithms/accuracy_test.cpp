// SPDX-License-Identifier: Apache-2.0
// Every algorithm of the registry slides over plane, ball, box, torus and knot, whose distance and normal are formulas.
//
// What is allowed is what sampling does to the field (samplingBound) and what the algorithm does to that, which
// methodBound() derives. The way: 1 voxel deep, 0.1 voxel a tick, planes renewed every tick.
#include <gtest/gtest.h>

#include "base/units.hpp"
#include "servo/safety/faults.hpp"
#include "support/algorithm_driver.hpp"
#include "support/algorithm_setups.hpp"
#include "support/analytic_surface.hpp"

namespace palpate {
namespace accuracy_test {

constexpr double kVoxel = 1e-3;      // [m]
constexpr double kDepth = 1e-3;      // [m]
constexpr double kStep_voxel = 0.1;  // a tick
const Vec3 kCentre = Vec3::Constant(31.3e-3);

// A surface with a way along it: a point at a depth below the surface for a length of way in metres.
struct TestSurface {
  const char* name;
  AnalyticSurface surface;
  std::function<Vec3(double way_m, double depth_m)> at;
  double radius_voxel;  // smallest radius of curvature within 1 voxel of the way; 0: flat
};

TestSurface plane() {
  const Vec3 n = Vec3(0.3, -0.5, 1).normalized();
  const Vec3 along = n.cross(Vec3(1, 0.2, 0)).normalized();
  return {"plane", planeSurface(kCentre, n),
          [=](double way_m, double depth_m) { return Vec3(kCentre + along * (way_m - 10e-3) - n * depth_m); }, 0};
}

TestSurface sphere() {
  const Vec3 u = Vec3(1, 0.3, 0.2).normalized();
  const Vec3 v = u.cross(Vec3(0.1, -0.4, 1)).normalized();
  return {"ball", ballSurface(kCentre, 20e-3),
          [=](double way_m, double depth_m) {
            const double a = way_m / 20e-3;
            return Vec3(kCentre + (u * std::cos(a) + v * std::sin(a)) * (20e-3 - depth_m));
          },
          19};
}

// On one face, 4 voxels and more from its edges.
TestSurface box() {
  return {"box", boxSurface(kCentre, Vec3(18e-3, 20e-3, 16e-3)),
          [=](double way_m, double depth_m) {
            return Vec3(kCentre + Vec3(-11e-3 + way_m, 0.4 * way_m - 5e-3, 16e-3 - depth_m));
          },
          0};
}

// Around the tube from outside to the hole: convex, then a saddle. Ring 18, tube 10 voxels: the hole has 8.
TestSurface torus() {
  return {"torus", torusSurface(kCentre, 18e-3, 10e-3),
          [=](double way_m, double depth_m) {
            const double a = way_m / 10e-3;
            const double turn = 0.6 + 0.2 * a;
            const Vec3 out(std::cos(turn), std::sin(turn), 0);
            return Vec3(kCentre + out * 18e-3 + (out * std::cos(a) + Vec3::UnitZ() * std::sin(a)) * (10e-3 - depth_m));
          },
          8};
}

// Along the knot and around its tube of 6 voxels.
TestSurface knot() {
  const TorusKnot knot(kCentre, 31e-3, 6e-3);
  return {"knot", knot.surface(),
          [=](double way_m, double depth_m) { return knot.below(0.15 + way_m / 60e-3, 0.2 + way_m / 12e-3, depth_m); },
          5};
}

struct Errors {
  double voxels = 0, radians = 0, newtons = 0;  // the largest
  int ticks = 0, missing = 0;
  std::uint32_t faults = 0;
};

double angleBetween(const Vec3& a, const Vec3& b) {
  return std::atan2(a.cross(b).norm(), a.dot(b));
}

AlgorithmParameters parameters() {
  AlgorithmParameters p;
  p.damping_Ns_per_m = 0;  // so that the force is K times depth
  p.plane_renewal_ticks = 1;
  return p;
}

Errors slideOver(const TestSurface& test, const AnalyticVolume& volume, std::string_view name) {
  const auto algorithm = makeFor(name, parameters(), volume, 4e-3);
  AlgorithmDriver driver(*algorithm, volume, test.at(0, -1e-3), 64);
  driver.follow = false;
  driver.at(test.at(0, -1e-3));
  driver.stroke(test.at(0, kDepth), 20);
  Errors errors;
  double way_m = 0;
  for (int i = 0; way_m < 20e-3; ++i) {
    way_m += kStep_voxel * kVoxel * 1e-3 / (test.at(way_m + 1e-3, kDepth) - test.at(way_m, kDepth)).norm();
    const Vec3 hip_W = test.at(way_m, kDepth);
    const TickOutput out = driver.at(hip_W);
    if (i < 5) continue;  // arriving
    ++errors.ticks;
    errors.faults |= out.faults;
    if (!out.in_contact || out.force_W.isZero(0)) {
      ++errors.missing;
      continue;
    }
    const double true_N = parameters().stiffness_N_per_m * -test.surface.distance_m(hip_W);
    errors.voxels = std::max(errors.voxels, std::abs(test.surface.distance_m(out.vhip_W)) / kVoxel);
    errors.radians = std::max(errors.radians, angleBetween(out.force_W, test.surface.normal(hip_W)));
    errors.newtons = std::max(errors.newtons, std::abs(out.force_W.norm() - true_N));
  }
  return errors;
}

// How much further the VHIP may be from the surface, and the force from the normal, than the field itself is.
SamplingBound methodBound(std::string_view name, double radius_voxel, const SamplingBound& field) {
  const double curvature = radius_voxel > 0 ? 1 / radius_voxel : 0;
  // The normal of a plane that was found `aside` voxels along the surface, and how far such a plane has left it.
  const auto aside = [&](double voxels) {
    return SamplingBound{0.5 * voxels * voxels * curvature, voxels * curvature};
  };
  // Depth is density over steepness, 1 voxel deep: it errs by as much as the steepness does.
  if (name == "avila") return {field.radians, 0};
  // Contact ends its inching at an angle of kAlignment between line and normal, at the surface 1 voxel off.
  if (name == "blezek") return aside(5e-3);
  // One pass leaves a part of depth times curvature of the way, here at most a fifth; two leave its square.
  if (name == "implicit") return aside(kStep_voxel * curvature * curvature);
  // The point nearest to the HIP is found to a fiftieth of a voxel; the normal is from before the last step, which is
  // at most as long as the tick's (surface_tracker.hpp).
  if (name == "hri") return aside(0.02 + kStep_voxel);
  // Every second tick, on the line from the VHIP of the tick before: between 0 and 2 ticks behind, then 1 more. What
  // it is behind leaves the next VHIP behind as well, as depth times curvature of it.
  if (name == "hri-paper" || name == "hri-paper-line") return aside(4 * kStep_voxel);
  ADD_FAILURE() << "derive a bound for " << name;
  return {0, 0};
}

class Accuracy : public testing::TestWithParam<TestSurface (*)()> {};

TEST_P(Accuracy, OfVhipAndForceIsThatOfTheSampledField) {
  const TestSurface test = GetParam()();
  const AnalyticVolume volume = sampledVolume(test.surface);
  // Floats: samples of up to 4e-3 m, seven lerps, the gradient's length; together some 1e-5 voxel and 1e-6 radians.
  SamplingBound field{2e-5, 2e-6};
  if (test.radius_voxel > 0) field = samplingBound(test.radius_voxel);
  for (const AlgorithmEntry& entry : algorithms()) {
    if (entry.name == "haptization") continue;  // it has no surface; below
    if (entry.needs.isosurface_mesh) continue;  // its surface is the mesh: tests/servo/objects/hybrid_test.cpp
    SCOPED_TRACE(std::string(entry.name) + " on the " + test.name);
    const Errors errors = slideOver(test, volume, entry.name);
    const SamplingBound method = methodBound(entry.name, test.radius_voxel, field);
    EXPECT_GT(errors.ticks, 150);
    EXPECT_EQ(errors.missing, 0);
    EXPECT_EQ(errors.faults, 0u) << faultNames(errors.faults);
    EXPECT_LE(errors.voxels, field.voxels + method.voxels);
    EXPECT_LE(errors.radians, field.radians + method.radians) << errors.radians * kDegreesPerRadian << " degrees";
    // Depth along a normal that is off by the angle differs by its cosine.
    const double tilt = field.radians + method.radians;
    EXPECT_LE(errors.newtons, 500 * kVoxel * (field.voxels + method.voxels + 0.5 * tilt * tilt));
    RecordProperty(std::string(entry.name) + "_voxel", std::to_string(errors.voxels));
    RecordProperty(std::string(entry.name) + "_degree", std::to_string(errors.radians * kDegreesPerRadian));
  }
}

// Its force is that of the table at the density under the tool, along the normal. The standard table rises to 3 N at
// half of 4 voxels of contrast: 1.5 N at a depth of 1 voxel, and 1.5 N more for each voxel that the density is off.
TEST_P(Accuracy, OfHaptizationIsThatOfTheSampledField) {
  const TestSurface test = GetParam()();
  const AnalyticVolume volume = sampledVolume(test.surface);
  const auto algorithm = makeFor("haptization", parameters(), volume, 4e-3);
  const SamplingBound field = test.radius_voxel > 0 ? samplingBound(test.radius_voxel) : SamplingBound{2e-5, 2e-6};
  AlgorithmDriver driver(*algorithm, volume, test.at(0, kDepth), 64);
  driver.follow = false;
  for (double way_m = 0; way_m < 18e-3; way_m += 0.05e-3) {
    const Vec3 hip_W = test.at(way_m, kDepth);
    driver.at(hip_W);
    const TickOutput out = driver.at(hip_W);  // at rest: no viscosity
    ASSERT_TRUE(out.in_contact);
    ASSERT_LE(angleBetween(out.force_W, test.surface.normal(hip_W)), field.radians);
    ASSERT_NEAR(out.force_W.norm(), -1.5 * test.surface.distance_m(hip_W) / kVoxel, 1.5 * field.voxels);
  }
}

INSTANTIATE_TEST_SUITE_P(Each, Accuracy, testing::Values(&plane, &sphere, &box, &torus, &knot),
                         [](const auto& test) { return std::string(test.param().name); });

}  // namespace accuracy_test
}  // namespace palpate
