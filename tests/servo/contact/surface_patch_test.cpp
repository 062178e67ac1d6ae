// SPDX-License-Identifier: Apache-2.0
#include "servo/contact/surface_patch.hpp"

#include <cmath>

#include <gtest/gtest.h>

#include "contact/plane_contact.hpp"
#include "servo/contact/shape_operator.hpp"
#include "support/sampled_volume.hpp"

namespace palpate {
namespace surface_patch_test {

constexpr double kRadius = 20e-3;

HeldWindow windowOn(const AnalyticVolume& volume) {
  HeldWindow held;
  volume.hold(held, Vec3i::Zero(), volume.size);
  return held;
}

// Gradients of R - |x| at samples R / h voxels out, w = 1.5 or 4 voxels aside either way: a secant errs by (w / R)^2 /
// 2 of 1 / R, central differences by (h / R)^2 / 6 and their interpolation by 3 / 8 (h / R)^2 (analytic_surface.hpp).
TEST(SurfacePatch, OnABallCurvatureIsOneOverTheRadiusAndTheNormalExact) {
  Seeded random(3);
  for (const double out : {1.0, -1.0}) {
    const Vec3 centre_W = Vec3::Constant(31.3e-3);
    const AnalyticVolume volume =
        millimetreVolume([=](const Vec3& p) { return out * (kRadius - (p - centre_W).norm()); });
    const HeldWindow held = windowOn(volume);
    for (int i = 0; i < 20; ++i) {
      const Vec3 radial = random.direction();
      const Vec3 normal_W = out * radial;
      for (const double spread : {1.5, 4.0}) {
        const SurfacePatch patch(WindowSampler(held.window), centre_W + kRadius * radial, normal_W,
                                 {.wider = spread == 4 ? 1.0 : 0.0});
        const double relative =
            0.5 * std::pow(spread * 1e-3 / kRadius, 2) + (1.0 / 6 + 3.0 / 8) * std::pow(1e-3 / kRadius, 2);
        ASSERT_TRUE(patch.known());
        EXPECT_LE((patch.normal() - normal_W).norm(), samplingBound(20).radians);
        const SurfacePatch::Curvature curvature = patch.curvature();
        const Vec3 q = random.across(normal_W);
        // The normals' own errors are divided by the way between them.
        const double bound = relative + samplingBound(20).radians / (spread * 1e-3) * kRadius;
        EXPECT_NEAR((kRadius * curvature.S_W * q - out * q).norm(), 0, bound) << spread;
        EXPECT_NEAR((curvature.S_W * normal_W).norm() * kRadius, 0, bound);
        EXPECT_LE(curvature.unevenness, relative * spread * 1e-3 / kRadius + samplingBound(20).radians);
        // Trilinear interpolation sags by h^2 / 8 in each of two directions; the rest is of fourth order.
        const Mat3 S_W = out / kRadius * (Mat3::Identity() - normal_W * normal_W.transpose());
        EXPECT_NEAR(patch.offset(0, S_W), 0,
                    0.25 * 1e-6 / kRadius + std::pow(spread * 1e-3, 4) / (8 * std::pow(kRadius, 3)));
      }
    }
  }
}

// A saddle, w + 60 a^2 / 2 - 40 b^2 / 2 in metres along a tilted normal and two directions across it: its gradients are
// linear, so samples of them hold them, and S has the eigenvalues 60 and -40. The secants of unit normals over ways of
// up to 1.5 mm are too small by (60 w)^2 / 2, below 0.5 % of 60 / m.
TEST(SurfacePatch, OnASaddleEachDirectionHasItsOwn) {
  AnalyticVolume volume;
  volume.lattice.spacing_m = Vec3(0.5e-3, 0.7e-3, 1e-3);
  volume.lattice.R_WL = someRotation();
  volume.size = Vec3i::Constant(20);
  const Vec3 p_W = volume.lattice.toWorld(Vec3(9.3, 10.2, 8.9));
  const Vec3 normal_W(0.48, 0.6, 0.64), across_W(0.8, 0, -0.6);
  const Vec3 a_W = std::cos(0.4) * across_W + std::sin(0.4) * normal_W.cross(across_W), b_W = normal_W.cross(a_W);
  volume.density = [&](const Vec3& at_W) {
    const Vec3 x = at_W - p_W;
    return -(normal_W.dot(x) + 30 * std::pow(a_W.dot(x), 2) - 20 * std::pow(b_W.dot(x), 2));
  };
  const HeldWindow held = windowOn(volume);
  const SurfacePatch patch(WindowSampler(held.window), p_W, normal_W, {});
  const ShapeOperator shape(normal_W, patch.curvature().S_W);
  for (const double angle : {0.0, 0.3, 0.8, 1.2, 1.57, 2.5}) {
    const double a = std::cos(angle), b = std::sin(angle);
    const Vec3 q = a * a_W + b * b_W + 0.7 * normal_W;  // the part along the normal does not count
    EXPECT_LT((shape.apply(q) - (60 * a * a_W - 40 * b * b_W)).norm(), 0.5) << angle;
    for (const double depth_m : {1e-3, 3e-3}) {
      const Vec3 wanted = a / (1 - 60 * depth_m) * a_W + b / (1 + 40 * depth_m) * b_W;
      EXPECT_LT((shape.slopeAtHip(q, depth_m) - wanted).norm(), 0.5 * 2 * depth_m) << angle;
    }
    // 15 mm deep 60 / m would multiply by ten, which is more than kMostGrowth; -40 / m still divides by 1.6.
    const Vec3 bounded = ShapeOperator::kMostGrowth * a * a_W + b / 1.6 * b_W;
    EXPECT_LT((shape.slopeAtHip(q, 15e-3) - bounded).norm(), 0.03) << angle;
  }
}

// White noise of s voxels: a component of a central difference has s / sqrt(2) of standard deviation at a sample, and
// less between samples, down to a half in the middle of eight. Over many patches the root mean square lies between.
TEST(SurfacePatch, TheUnevennessIsThatOfTheNoise) {
  for (const double noise : {0.02, 0.1}) {
    Sampling sampling{.size = Vec3i::Constant(64), .noise_m = noise * 1e-3, .seed = 8};
    const Vec3 normal_W = Vec3(0.3, 0.5, 0.8).normalized(), middle_W = Vec3::Constant(31.5e-3);
    const AnalyticVolume volume = stored(sampledOn(sampling, planeSurface(middle_W, normal_W)));
    const HeldWindow held = windowOn(volume);
    const WindowSampler sampler(held.window);
    Seeded random(4);
    double squares = 0, offsets = 0, point_offsets = 0;
    constexpr int kPatches = 400;
    for (int i = 0; i < kPatches; ++i) {
      Vec3 p_W = middle_W + random.inCube(15e-3);
      p_W -= normal_W * normal_W.dot(p_W - middle_W);
      const SurfacePatch patch(sampler, p_W, normal_W, {.wider = 1});
      ASSERT_TRUE(patch.known());
      const SurfacePatch::Curvature curvature = patch.curvature();
      squares += std::pow(curvature.unevenness, 2);
      offsets += std::pow(patch.offset(0, Mat3::Zero()), 2);
      point_offsets += std::pow(sampler.at(p_W).density, 2);
    }
    const double unevenness = std::sqrt(squares / kPatches);
    EXPECT_GT(unevenness, 0.25 * noise);
    EXPECT_LT(unevenness, 0.75 * noise);
    // Seven places: sqrt(7) = 2.6 times less than one, but for the noise of the steepness.
    EXPECT_LT(std::sqrt(offsets / point_offsets), 1 / 2.2);
  }
}

// Slices of 3 mm: across them a pair is six times as wide apart as within them.
TEST(SurfacePatch, IsAsWideInVoxelsAlongEachAxis) {
  AnalyticVolume volume;
  volume.lattice.spacing_m = Vec3(0.5e-3, 0.5e-3, 3e-3);
  volume.size = Vec3i(40, 40, 20);
  volume.density = [](const Vec3& p) { return p.x(); };
  const HeldWindow held = windowOn(volume);
  const SurfacePatch patch(WindowSampler(held.window), volume.lattice.toWorld(Vec3(20, 20, 10)), -Vec3::UnitX(), {});
  EXPECT_NEAR(patch.ways()[0].norm(), 0, 1e-15);
  EXPECT_NEAR(patch.ways()[1].norm(), 0.75e-3, 1e-15);
  EXPECT_NEAR(patch.ways()[2].norm(), 4.5e-3, 1e-15);
}

// Where one of a pair has no gradient, or faces the other way, the pair says nothing; with fewer than two pairs the
// surface is flat. Without gradients at all there is no normal.
TEST(SurfacePatch, WhatIsNotKnownCountsAsFlat) {
  const AnalyticVolume volume = millimetreVolume(ball(Vec3::Constant(16e-3), 10e-3), 32);
  HeldWindow held = windowOn(volume);
  const Vec3 normal_W = Vec3(1, 2, 3).normalized();
  const Vec3 p_W = Vec3::Constant(16e-3) + 10e-3 * normal_W;
  ASSERT_FALSE(SurfacePatch(WindowSampler(held.window), p_W, normal_W, {}).curvature().S_W.isZero(0));
  for (Sample& sample : held.samples) sample.gradient_i = sample.gradient_j = sample.gradient_k = 0;
  EXPECT_FALSE(SurfacePatch(WindowSampler(held.window), p_W, normal_W, {}).known());
  // A wall of one voxel: its other side is 1.5 voxels away, where the gradients face the other way.
  const AnalyticVolume wall =
      millimetreVolume([](const Vec3& p) { return p.x() < 16.2e-3 ? p.x() - 15e-3 : 17.4e-3 - p.x(); }, 32);
  const HeldWindow of_wall = windowOn(wall);
  const SurfacePatch patch(WindowSampler(of_wall.window), Vec3(15e-3, 16e-3, 16e-3), Vec3(-0.6, 0.8, 0),
                           {.wider = 0.6});
  EXPECT_TRUE(patch.curvature().S_W.allFinite());
}

TEST(ShapeOperator, OfAFlatSurfaceChangesNothing) {
  const Vec3 normal_W = Vec3(1, 2, 3).normalized();
  const Vec3 q = normal_W.cross(Vec3::UnitX());
  const ShapeOperator flat(normal_W);
  EXPECT_EQ(flat.apply(q), Vec3::Zero());
  EXPECT_NEAR((flat.slopeAtHip(q, 1e-3) - q).norm(), 0, 1e-15);
  EXPECT_NEAR(flat.slopeAtHip(normal_W, 1e-3).norm(), 0, 1e-15);
}

}  // namespace surface_patch_test
}  // namespace palpate
