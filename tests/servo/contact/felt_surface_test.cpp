// SPDX-License-Identifier: Apache-2.0
#include "servo/contact/felt_surface.hpp"

#include <cmath>
#include <cstdlib>
#include <utility>

#include <gtest/gtest.h>

#include "base/units.hpp"
#include "servo/contact/edit_ease.hpp"
#include "support/sampled_volume.hpp"

namespace palpate {
namespace felt_surface_test {

constexpr double kVoxel = 1e-3;
constexpr double kRadius = 20e-3;
constexpr double kDepth = 4e-3;
constexpr double kStep = 0.1e-3;  // a tick

double angleBetween(const Vec3& a, const Vec3& b) {
  return std::atan2(a.cross(b).norm(), a.dot(b));
}

// A tool that slides under a ball around the origin, with an exact plane or one that is given.
struct Slide {
  explicit Slide(double noise_voxel, unsigned seed = 1, bool mask = false) {
    Sampling sampling{.size = Vec3i::Constant(64), .noise_m = noise_voxel * kVoxel, .seed = seed};
    sampling.lattice = latticeAround(Vec3(0, 0, kRadius), sampling.size, Vec3::Constant(kVoxel));
    volume = sampledOn(sampling, ballSurface(Vec3::Zero(), kRadius));
    if (mask) {
      volume.density = [ball = volume.density](const Vec3& p_W) { return ball(p_W) > 0 ? 0.5e-3 : -0.5e-3; };
    }
    volume.hold(held, Vec3i::Zero(), volume.size);
  }
  [[nodiscard]] Vec3 normal(int tick) const {
    const double angle = (tick - 80) * kStep / (kRadius - kDepth);
    return {std::sin(angle), 0.1 * std::sin(angle), std::cos(angle)};
  }
  // The tick's felt point, on the exact plane turned by `off`, about y.
  const FeltPoint& at(int tick, double off = 0) {
    const Vec3 n_W = normal(tick).normalized();
    const Vec3 plane_W = Eigen::AngleAxisd(off, Vec3::UnitY()) * n_W;
    hip_W = n_W * (kRadius - kDepth);
    const FeltPoint& felt = surface.feel(
        {.hip_W = hip_W, .plane = {hip_W + kDepth * plane_W, plane_W, 0}, .begins = tick == 0, .window = &held.window});
    return felt;
  }
  AnalyticVolume volume;
  HeldWindow held;
  FeltSurface surface{0, 1000};
  Vec3 hip_W = Vec3::Zero();
};

// On the exact ball: the normal of the samples, within their bound; the point under the tool; 1 / R.
TEST(FeltSurface, OnASmoothSurfaceItIsTheSurface) {
  Slide slide(0);
  const double angle = samplingBound(kRadius / kVoxel).radians;
  for (int tick = 0; tick < 160; ++tick) {
    const FeltPoint& felt = slide.at(tick);
    const Vec3 n_W = slide.normal(tick).normalized();
    EXPECT_LE(angleBetween(felt.normal_W, n_W), 2 * angle) << tick;
    EXPECT_NEAR(felt.depth_m, kDepth, 0.01 * kVoxel);
    EXPECT_LE((felt.p_W - n_W * kRadius).norm(), 2 * angle * kDepth + 0.01 * kVoxel);
    EXPECT_EQ(felt.p_W, felt.now_W);
    const Vec3 q = n_W.cross(Vec3::UnitY()).normalized();
    EXPECT_NEAR((felt.shape.apply(q) * kRadius - q).norm(), 0, 0.05) << tick;
    EXPECT_LT(felt.roughness, 0.05);
  }
}

// A plane that lags, as one of an old renewal does, is not followed: the normal is that under the tool.
TEST(FeltSurface, AnOldPlaneDoesNotTurnIt) {
  Slide slide(0);
  for (int tick = 0; tick < 160; ++tick) {
    const FeltPoint& felt = slide.at(tick, -0.05);
    if (tick <= 10) continue;
    EXPECT_LE(angleBetween(felt.normal_W, slide.normal(tick)), 0.006) << tick;
  }
}

// On a rough surface the felt point moves with the tool, R / (R - D) = 1.25 times as fast, and hardly faster, whereas
// one sample's normal jumps; and the normal is nearer to the truth.
TEST(FeltSurface, OnNoiseAndMasksThePointGlides) {
  for (const bool mask : {false, true}) {
    for (unsigned seed = 1; seed <= (mask ? 1U : 10U); ++seed) {
      Slide slide(mask ? 0 : 0.25, seed, mask);
      const WindowSampler sampler(slide.held.window);
      Vec3 last_W = Vec3::Zero(), last_hip_W = Vec3::Zero(), last_raw_W = Vec3::Zero();
      double fastest = 0, fastest_raw = 0, felt_squares = 0, raw_squares = 0;
      for (int tick = 0; tick < 160; ++tick) {
        const FeltPoint& felt = slide.at(tick);
        const Vec3 n_W = slide.normal(tick).normalized();
        const Vec3 raw_W = -sampler.at(n_W * kRadius).gradient_W.normalized();
        felt_squares += std::pow(angleBetween(felt.normal_W, n_W), 2);
        raw_squares += std::pow(angleBetween(raw_W, n_W), 2);
        if (tick > 0) {
          const double way_m = (slide.hip_W - last_hip_W).norm();
          fastest = std::max(fastest, (felt.p_W - last_W).norm() / way_m);
          fastest_raw =
              std::max(fastest_raw, (slide.hip_W + raw_W * kDepth - last_hip_W - last_raw_W * kDepth).norm() / way_m);
        }
        last_W = felt.p_W;
        last_hip_W = slide.hip_W;
        last_raw_W = raw_W;
      }
      EXPECT_LE(fastest, 2 * kRadius / (kRadius - kDepth)) << mask << " " << seed;
      EXPECT_GT(fastest_raw, 1.5 * fastest) << mask << " " << seed;
      EXPECT_LT(felt_squares, 0.6 * raw_squares) << mask << " " << seed;
    }
  }
}

// At rest an error of the beginning goes: the way grows by kRest voxels a second, kLongest / kRest = 0.6 s long.
TEST(FeltSurface, AtRestItComesToWhatIsMeasured) {
  Slide slide(0.25, 3);
  for (int tick = 0; tick < 60; ++tick) static_cast<void>(slide.at(tick));
  for (int i = 0; i < 6000; ++i) static_cast<void>(slide.at(59));
  const FeltPoint& felt = slide.at(59);
  const SurfacePatch patch(WindowSampler(slide.held.window), felt.p_W, felt.normal_W,
                           {.depth_m = kDepth, .wider = felt.roughness});
  EXPECT_LE(angleBetween(felt.normal_W, patch.normal()), 0.02);
}

// An edit turns the surface by 0.3 at the tool: what is felt turns evenly over EditEase::kTime_s.
TEST(FeltSurface, WhatAnEditTurnsIsTakenInEvenly) {
  const auto tilted = [](double angle) {
    const Vec3 n_W(std::sin(angle), 0, std::cos(angle));
    return millimetreVolume([=](const Vec3& p_W) { return -n_W.dot(p_W - Vec3::Constant(16e-3)); }, 32);
  };
  HeldWindow held;
  tilted(0).hold(held, Vec3i::Zero(), Vec3i::Constant(32), 1);
  FeltSurface surface(0, 1000);
  const Vec3 hip_W = Vec3(16e-3, 16e-3, 14e-3);
  const auto feel = [&](double angle, bool begins) {
    const Vec3 n_W(std::sin(angle), 0, std::cos(angle));
    return surface.feel(
        {.hip_W = hip_W, .plane = {Vec3::Constant(16e-3), n_W, 0}, .begins = begins, .window = &held.window});
  };
  for (int i = 0; i < 10; ++i) static_cast<void>(feel(0, i == 0));
  tilted(0.3).hold(held, Vec3i::Zero(), Vec3i::Constant(32), 2);
  held.window.edit_version = 1;
  double last = 0;
  const int ticks = static_cast<int>(std::lround(EditEase::kTime_s * 1000));
  for (int i = 0; i < ticks; ++i) {
    const FeltPoint felt = feel(0.3, false);
    EXPECT_EQ(felt.edited, i == 0);
    const double turned = angleBetween(felt.normal_W, Vec3::UnitZ());
    ASSERT_GE(turned, last - 1e-6) << i;
    ASSERT_LE(turned - last, 1.1 * 0.3 / ticks) << i;
    last = turned;
  }
  EXPECT_NEAR(last, 0.3, 1e-3);
}

// While depth is taken in, the felt point is that of the plane as it is shown; samples are read on the volume's
// surface.
TEST(FeltSurface, SamplesAreReadOnTheVolumesSurface) {
  Slide slide(0);
  const Vec3 n_W = slide.normal(80).normalized();
  const FeltPoint felt = slide.surface.feel({.hip_W = n_W * (kRadius - kDepth),
                                             .plane = {n_W * (kRadius - 1e-3), n_W, 0},
                                             .eased_m = 1e-3,
                                             .begins = true,
                                             .window = &slide.held.window});
  EXPECT_NEAR((felt.p_W - n_W * (kRadius - 1e-3)).norm(), 0, 0.02 * kVoxel);
  EXPECT_NEAR((felt.now_W - n_W * kRadius).norm(), 0, 0.02 * kVoxel);
  EXPECT_NEAR(felt.depth_m, kDepth - 1e-3, 1e-12);
}

// All along a slide: the curvature is that of the volume's surface, 1 / R, not of a shell as far below it as above.
TEST(FeltSurface, WhileDepthIsTakenInItBendsAsTheVolumesSurface) {
  Slide slide(0);
  constexpr double kEased = 2e-3;
  for (int tick = 0; tick < 160; ++tick) {
    const Vec3 n_W = slide.normal(tick).normalized();
    const FeltPoint& felt = slide.surface.feel({.hip_W = n_W * (kRadius - kDepth),
                                                .plane = {n_W * (kRadius - kEased), n_W, 0},
                                                .eased_m = kEased,
                                                .begins = tick == 0,
                                                .window = &slide.held.window});
    const Vec3 q = n_W.cross(Vec3::UnitY()).normalized();
    EXPECT_NEAR((felt.shape.apply(q) * kRadius - q).norm(), 0, 0.05) << tick;
    EXPECT_NEAR((felt.now_W - n_W * kRadius).norm(), 0, 0.05 * kVoxel) << tick;
  }
}

// Where another object holds the tool, or nothing is known, it is the plane, and flat; nothing of the volume is read.
TEST(FeltSurface, WithoutTheVolumeItIsThePlane) {
  Slide slide(0);
  const Vec3 n_W = Vec3(0.6, 0, 0.8), hip_W(0, 0, kRadius - kDepth);
  SampleWindow none;
  for (const bool on_volume : {false, true}) {
    for (int i = 0; i < 3; ++i) {
      const FeltPoint felt = slide.surface.feel({.hip_W = hip_W,
                                                 .plane = {hip_W + 2e-3 * n_W, n_W, 0},
                                                 .begins = i == 0,
                                                 .on_volume = on_volume,
                                                 .window = on_volume ? &none : &slide.held.window});
      EXPECT_LE((felt.normal_W - n_W).norm(), 1e-12);
      EXPECT_NEAR((felt.p_W - hip_W - 2e-3 * n_W).norm(), 0, 1e-12);
      EXPECT_NEAR(felt.shape.apply(Vec3(0, 1, 0)).norm(), 0, 1e-12);
      EXPECT_EQ(felt.window, nullptr);
    }
  }
}

// A wrong reading far away begins anew, and what comes with it is finite.
TEST(FeltSurface, ALeapBeginsAnew) {
  Slide slide(0.25);
  for (int tick = 0; tick < 40; ++tick) static_cast<void>(slide.at(tick));
  const FeltPoint felt = slide.surface.feel(
      {.hip_W = Vec3(1, 0, 0), .plane = {Vec3(1.001, 0, 0), Vec3::UnitX(), 0}, .window = &slide.held.window});
  EXPECT_TRUE(felt.p_W.allFinite());
  EXPECT_EQ(felt.normal_W, Vec3::UnitX());
}

// Nothing of an earlier run is kept: not its windows either, whose versions and storage may come again.
TEST(FeltSurface, ReleasedItForgetsTheWindow) {
  Slide slide(0.25), fresh(0.25);
  for (int tick = 0; tick < 40; ++tick) {
    slide.held.window.edit_version = tick / 10;  // what these edits turn is not all taken in yet
    static_cast<void>(slide.at(tick));
  }
  slide.surface.release();
  for (Slide* each : {&slide, &fresh}) each->held.window.lattice.origin_W.x() += 0.4 * kVoxel;
  for (int tick = 0; tick < 20; ++tick) {
    const FeltPoint a = slide.at(tick), b = fresh.at(tick);
    ASSERT_EQ(a.normal_W, b.normal_W) << tick;
    ASSERT_EQ(a.p_W, b.p_W) << tick;
  }
}

// The first window is no edit, however late it comes: what it shows is not taken in over half a second.
TEST(FeltSurface, TheFirstWindowIsNoEdit) {
  Slide slide(0);
  const std::uint64_t version = std::exchange(slide.held.window.version, 0);
  slide.held.window.edit_version = 7;
  for (int tick = 0; tick < 5; ++tick) static_cast<void>(slide.at(tick, 0.05));
  slide.held.window.version = version;
  const FeltPoint felt = slide.at(5, 0.05);
  EXPECT_FALSE(felt.edited);
  // It is measured where the plane puts the surface point: 0.05 D aside, where the ball's normal is 0.05 D / R off.
  EXPECT_LE(angleBetween(felt.normal_W, slide.normal(5)), 1.1 * 0.05 * kDepth / kRadius);
}

// On the exact ball the place at which fields are read is the surface point. Where the surface point jumps, here since
// windows show another ball, the place follows at 1.5 times the speed that the curvature explains.
TEST(FeltSurface, ThePlaceDoesNotJump) {
  Slide slide(0);
  Vec3 last_W = Vec3::Zero();
  double farthest_m = 0;
  for (int tick = 0; tick < 120; ++tick) {
    if (tick == 60) {
      AnalyticVolume other = slide.volume;
      other.density = [ball = slide.volume.density](const Vec3& p_W) { return ball(p_W - Vec3(8e-3, 0, 0)); };
      other.hold(slide.held, Vec3i::Zero(), other.size, 2);
    }
    const FeltPoint felt = slide.at(tick);
    if (tick < 60) {
      EXPECT_EQ(felt.place_W, felt.p_W) << tick;
    }
    farthest_m = std::max(farthest_m, (felt.p_W - felt.place_W).norm());
    const double way_m = 1.005 * kStep * kRadius / (kRadius - kDepth);
    if (tick > 0) {
      ASSERT_LE((felt.place_W - last_W).norm(), 1.06 * FeltSurface::kMostAhead * way_m) << tick;
    }
    last_W = felt.place_W;
  }
  EXPECT_GT(farthest_m, kVoxel);
}

}  // namespace felt_surface_test
}  // namespace palpate
