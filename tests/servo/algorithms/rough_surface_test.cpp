// SPDX-License-Identifier: Apache-2.0
// hri pressed 1 to 30 voxels deep on surfaces with noise: no contact is lost, and the force is steady.
//
// A press of `depth` at 0.1 m/s, then a slide of 25 voxels over the surface at 0.1 m/s; voxels of 1 mm, 500 N/m, no
// damping. Noise is Gaussian, the same standard deviation at every sample, in voxels of a density with gradient 1.
#include <algorithm>

#include <fmt/format.h>
#include <gtest/gtest.h>

#include "base/units.hpp"
#include "servo/algorithms/hri.hpp"
#include "servo/safety/faults.hpp"
#include "support/algorithm_driver.hpp"
#include "support/sampled_volume.hpp"

namespace palpate {
namespace rough_surface_test {

constexpr double kVoxel = 1e-3;
constexpr double kStep = 0.1e-3;    // a tick [m]
constexpr double kRadius = 40e-3;   // of ball and hollow [m]
constexpr double kLength = 25e-3;   // of the slide [m]
constexpr double kStiffness = 500;  // [N/m]

enum class Shape { kPlane, kBall, kHollow };

// The surface, and the point `way` along it and `depth` below.
struct Ground {
  Ground(Shape kind, Seeded& random) : shape(kind), out_W(random.direction()), aside_W(random.across(out_W)) {
    const AnalyticSurface solid = ballSurface(Vec3::Zero(), kRadius);
    surface = shape == Shape::kPlane  ? planeSurface(out_W * kRadius, out_W)
              : shape == Shape::kBall ? solid
                                      : hollow(solid);
  }
  [[nodiscard]] Vec3 at(double way_m, double depth_m) const {
    if (shape == Shape::kPlane) return out_W * (kRadius - depth_m) + aside_W * way_m;
    // The faster of HIP and VHIP goes at the speed.
    const double angle = way_m / (shape == Shape::kBall ? kRadius : kRadius + std::max(0.0, depth_m));
    const double radius_m = kRadius + (shape == Shape::kBall ? -depth_m : depth_m);
    return (out_W * std::cos(angle) + aside_W * std::sin(angle)) * radius_m;
  }

  Shape shape;
  Vec3 out_W, aside_W;
  AnalyticSurface surface;
};

struct Felt {
  int lost = 0;  // ticks without contact
  std::uint32_t faults = 0;
  double jump_N = 0;  // the largest from tick to tick
  std::vector<double> degrees;
};

Felt pressAndSlide(const Ground& ground, double noise_voxel, double depth_voxel, int n, unsigned seed) {
  Sampling sampling{.size = Vec3i::Constant(260), .noise_m = noise_voxel * kVoxel, .seed = seed};
  sampling.lattice = latticeAround(ground.at(0, 0), sampling.size, Vec3::Constant(kVoxel));
  const AnalyticVolume volume = sampledOn(sampling, ground.surface);
  Hri hri({.stiffness_N_per_m = kStiffness, .damping_Ns_per_m = 0, .plane_renewal_ticks = n});
  AlgorithmDriver driver(hri, volume, ground.at(0, -3 * kVoxel));
  driver.around_vhip = true;
  Felt felt;
  // The surface is where the noise puts it; from four deviations and half a voxel on the HIP is below it everywhere.
  const double below_m = (4 * noise_voxel + 0.5) * kVoxel;
  Vec3 last_W = Vec3::Zero();
  const auto tick = [&](double way_m, double depth_m) {
    const Vec3 hip_W = ground.at(way_m, depth_m);
    const TickOutput out = driver.at(hip_W);
    const double jump_N = (out.force_W - last_W).norm();
    last_W = out.force_W;
    if (depth_m < below_m) return;
    felt.faults |= out.faults;
    felt.jump_N = std::max(felt.jump_N, jump_N);
    if (!out.in_contact) {
      ++felt.lost;
      return;
    }
    const Vec3 normal_W = ground.surface.normal(hip_W);
    felt.degrees.push_back(std::atan2(out.force_W.cross(normal_W).norm(), out.force_W.dot(normal_W)) *
                           kDegreesPerRadian);
  };
  for (double depth_m = -3 * kVoxel; depth_m < depth_voxel * kVoxel; depth_m += kStep) tick(0, depth_m);
  for (double way_m = 0; way_m < kLength; way_m += kStep) tick(way_m, depth_voxel * kVoxel);
  return felt;
}

double median(std::vector<double> values) {
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

// What the same presses gave where every plane took the normal of the one sample point nearest to the HIP, as the
// virtual plane of the paper does: the largest jump, and the median of all angles. Measured by this test on commit
// 5e017c8, the last that did so.
struct OneSample {
  double noise_voxel;
  double jump_N[3], median_degrees[3];  // plane, ball, hollow
};
constexpr OneSample kOneSample[] = {
    {0.1, {2.36, 2.71, 2.34}, {2.46, 2.83, 2.29}},
    {0.25, {6.42, 6.42, 7.63}, {7.03, 8.06, 6.69}},
    {0.35, {10.40, 12.22, 11.50}, {10.41, 10.89, 10.10}},
    {0.5, {8.16, 8.14, 8.91}, {13.33, 14.49, 12.41}},
};

class RoughSurface : public testing::TestWithParam<Shape> {};

TEST_P(RoughSurface, NoContactIsLostAndJumpsAreAThirdOfThoseOfOneSamplesNormal) {
  constexpr unsigned kSeeds = 100;
  for (const OneSample& old : kOneSample) {
    Felt all;
    for (unsigned seed = 1; seed <= kSeeds / std::size(kOneSample); ++seed) {
      Seeded random(seed + static_cast<unsigned>(1000 * old.noise_voxel));
      const Ground ground(GetParam(), random);
      const double depth_voxel = random.logBetween(1, 30);
      const int n = static_cast<int>(std::lround(random.logBetween(1, 20)));
      const Felt felt = pressAndSlide(ground, old.noise_voxel, depth_voxel, n, seed);
      EXPECT_EQ(felt.lost, 0) << "noise " << old.noise_voxel << ", seed " << seed << ", " << depth_voxel << " deep, n "
                              << n << " " << faultNames(felt.faults);
      EXPECT_EQ(felt.faults & kFadingFaults, 0U) << seed << " " << faultNames(felt.faults);
      all.jump_N = std::max(all.jump_N, felt.jump_N);
      all.degrees.insert(all.degrees.end(), felt.degrees.begin(), felt.degrees.end());
    }
    const auto shape = static_cast<std::size_t>(GetParam());
    ASSERT_GT(all.degrees.size(), 4000U);
    const double median_degrees = median(all.degrees);
    EXPECT_LE(all.jump_N, old.jump_N[shape] / 3) << "noise " << old.noise_voxel;
    EXPECT_LE(median_degrees, old.median_degrees[shape]) << "noise " << old.noise_voxel;
    RecordProperty(fmt::format("jump_N at noise {}", old.noise_voxel), std::to_string(all.jump_N));
    RecordProperty(fmt::format("median_degrees at noise {}", old.noise_voxel), std::to_string(median_degrees));
  }
}

INSTANTIATE_TEST_SUITE_P(
    Each, RoughSurface, testing::Values(Shape::kPlane, Shape::kBall, Shape::kHollow), [](const auto& test) {
      return std::string(std::array{"Plane", "Ball", "Hollow"}[static_cast<std::size_t>(test.param)]);
    });

// What was learned of one surface is forgotten when it is left: on a smooth one the trace is that of a tool that never
// was on the rough one, bit for bit.
TEST(RoughSurfaceMemory, EndsWithTheContact) {
  Seeded random(9);
  Sampling sampling{.size = Vec3i::Constant(72)};
  const AnalyticSurface ground = planeSurface(Vec3(0, 0, 40.3e-3), Vec3(0.1, 0.05, 1));
  const AnalyticVolume smooth = sampledOn(sampling, ground);
  sampling.noise_m = 0.5 * kVoxel;
  const AnalyticVolume rough = sampledOn(sampling, ground);
  AnalyticVolume volume = smooth;  // rough where x is below the middle
  volume.density = [=](const Vec3& p_W) { return p_W.x() < 36e-3 ? rough.density(p_W) : smooth.density(p_W); };
  const Vec3 free_W(54e-3, 36e-3, 45e-3);
  const auto onSmooth = [&](AlgorithmDriver& driver) {
    std::vector<TickOutput> outs = driver.stroke(Vec3(54e-3, 36e-3, 26e-3), 100);
    for (const TickOutput& out : driver.stroke(Vec3(58e-3, 40e-3, 26e-3), 60)) outs.push_back(out);
    return outs;
  };
  for (const int n : {1, 5}) {
    const AlgorithmParameters parameters{.damping_Ns_per_m = 0, .plane_renewal_ticks = n};
    Hri fresh(parameters), used(parameters);
    AlgorithmDriver a(fresh, volume, free_W, 72), b(used, volume, Vec3(16e-3, 36e-3, 48e-3), 72);
    a.follow = b.follow = false;
    a.at(free_W);
    b.stroke(Vec3(16e-3, 36e-3, 24e-3), 200);
    b.stroke(Vec3(24e-3, 40e-3, 24e-3), 80);
    b.stroke(Vec3(24e-3, 40e-3, 52e-3), 1);  // at once, so that nothing is unlearned on the way out
    ASSERT_FALSE(b.stroke(free_W, 50).back().in_contact);
    const auto of_a = onSmooth(a);
    const auto of_b = onSmooth(b);
    int touching = 0;
    for (std::size_t i = 0; i < of_a.size(); ++i) {
      ASSERT_EQ(of_a[i].force_W, of_b[i].force_W) << n << " " << i;
      touching += of_a[i].in_contact ? 1 : 0;
    }
    EXPECT_GT(touching, 60);  // the whole slide, and some of the press
  }
}

// On a rough surface, too, a way longer than a search follows is told.
TEST(RoughSurfaceMemory, AWayThatIsTooLongIsToldOnARoughSurface) {
  Sampling sampling{.size = Vec3i(200, 60, 60), .noise_m = 0.5 * kVoxel, .seed = 3};
  const AnalyticVolume volume = sampledOn(sampling, planeSurface(Vec3(0, 0, 40.3e-3), Vec3::UnitZ()));
  Hri hri({.damping_Ns_per_m = 0, .plane_renewal_ticks = 1});
  AlgorithmDriver driver(hri, volume, Vec3(30e-3, 30e-3, 46e-3), 200);
  driver.follow = false;
  driver.at(Vec3(30e-3, 30e-3, 46e-3));
  driver.stroke(Vec3(30e-3, 30e-3, 30e-3), 160);
  driver.stroke(Vec3(36e-3, 30e-3, 30e-3), 60);
  EXPECT_TRUE(has(driver.at(Vec3(150e-3, 30e-3, 30e-3)).faults, ServoFault::kPlaneBehind));
}

// Once round a noisy ball of R = 40 voxels, 24 deep: the surface point has to go 2.5 times as fast as the HIP, at
// r = 16 from the middle, all the way. Noise of s voxels lets a point nearest be that much, and with it so far aside:
// the distance from the HIP grows by r w^2 / (2 R D) over a way w on the surface, so w^2 = 2 R D / r times what noise
// can make up for, 4 s. Seen from the HIP that is the angle whose tangent is R sin(w / R) / (R cos(w / R) - r). A plane
// that is not renewed every tick may be turned by kMostTurned besides.
TEST(RoughSurfaces, TheSurfacePointKeepsUpAllTheWayRound) {
  constexpr double kDeep = 24e-3, kInner = kRadius - kDeep;
  for (const double noise_voxel : {0.1, 0.25, 0.5}) {
    const double way_m = std::sqrt(8 * noise_voxel * kVoxel * kRadius * kDeep / kInner);
    const double aside = way_m / kRadius;
    const double nearest = std::atan2(kRadius * std::sin(aside), kRadius * std::cos(aside) - kInner);
    for (const int n : {1, 5, 20}) {
      const double bound_deg = (nearest + (n > 1 ? HriSurface::kMostTurned : 0)) * kDegreesPerRadian;
      Seeded random(static_cast<unsigned>(100 * noise_voxel) + static_cast<unsigned>(n));
      const Ground ground(Shape::kBall, random);
      Sampling sampling{.size = Vec3i::Constant(96), .noise_m = noise_voxel * kVoxel, .seed = 5};
      sampling.lattice = latticeAround(Vec3::Zero(), sampling.size, Vec3::Constant(kVoxel));
      const AnalyticVolume volume = sampledOn(sampling, ground.surface);
      Hri hri({.stiffness_N_per_m = kStiffness, .damping_Ns_per_m = 0, .plane_renewal_ticks = n});
      AlgorithmDriver driver(hri, volume, ground.at(0, -3 * kVoxel));
      driver.around_vhip = true;
      driver.stroke(ground.at(0, kDeep), 270);
      std::vector<double> degrees;
      for (double angle = 0; angle < 6.28; angle += kStep / kInner) {
        const Vec3 hip_W = ground.at(angle * kRadius, kDeep);
        const TickOutput out = driver.at(hip_W);
        ASSERT_TRUE(out.in_contact) << noise_voxel << " " << n;
        ASSERT_EQ(out.faults & kFadingFaults, 0U) << faultNames(out.faults);
        degrees.push_back(std::atan2(out.force_W.cross(hip_W).norm(), out.force_W.dot(hip_W)) * kDegreesPerRadian);
      }
      std::sort(degrees.begin(), degrees.end());
      EXPECT_LE(degrees[degrees.size() * 99 / 100], bound_deg) << noise_voxel << " " << n;
      RecordProperty(fmt::format("p99_degrees_noise{:g}_n{}", noise_voxel, n),
                     fmt::format("{:.1f}, bound {:.1f}", degrees[degrees.size() * 99 / 100], bound_deg));
    }
  }
}

}  // namespace rough_surface_test
}  // namespace palpate
