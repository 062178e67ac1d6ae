// SPDX-License-Identifier: Apache-2.0
#include "servo/contact/texture.hpp"

#include <algorithm>
#include <cmath>
#include <complex>
#include <numbers>

#include <gtest/gtest.h>

#include "contact/plane_contact.hpp"
#include "support/analytic_volume.hpp"
#include "support/seeded.hpp"

namespace palpate {
namespace texture_test {

constexpr double kAmplitude = 0.1e-3;
constexpr double kWavelength = 1.3e-3;
constexpr double kDepth = 1e-3;

// ---- procedural ----

// Points of a line that no wave runs square to.
Vec3 onLine(double s_m) {
  return Vec3(0.01, -0.02, 0.03) + s_m * Vec3(0.48, 0.6, 0.64);
}
const Vec3 kLine(0.48, 0.6, 0.64);

TEST(ProceduralTexture, EveryWaveHasTheWavelengthAndNoneLiesAlongAnAxis) {
  const ProceduralTexture texture(kAmplitude, kWavelength);
  Vec3 sum = Vec3::Zero();
  for (int i = 0; i < ProceduralTexture::kWaves; ++i) {
    const Vec3& k = texture.waveVector(i);
    EXPECT_NEAR(k.norm() * kWavelength, 2 * std::numbers::pi, 1e-12);
    for (int axis = 0; axis < 3; ++axis) {
      EXPECT_LT(std::abs(k[axis]), std::cos(28.0 / 180 * std::numbers::pi) * k.norm());
      // On a plane across the axis no two have nearly the same length.
      for (int j = 0; j < i; ++j)
        EXPECT_GT(std::abs(std::abs(k[axis]) - std::abs(texture.waveVector(j)[axis])), 0.15 * k.norm());
    }
    sum += k;
  }
  EXPECT_NEAR(sum.norm() * kWavelength, 0, 1e-12);  // a regular tetrahedron
}

// The bound is exact: four sines of A / 4. That it is nearly reached says that the amplitude is what it is called.
TEST(ProceduralTexture, StaysWithinItsAmplitudeAndNearlyReachesIt) {
  const ProceduralTexture texture(kAmplitude, kWavelength);
  double highest = 0, lowest = 0;
  for (int i = 0; i < 200'000; ++i) {
    const double h = texture.height(onLine(i * 0.11e-3));
    highest = std::max(highest, h);
    lowest = std::min(lowest, h);
  }
  EXPECT_LE(highest, kAmplitude);
  EXPECT_GE(lowest, -kAmplitude);
  EXPECT_GT(highest, 0.95 * kAmplitude);
  EXPECT_LT(lowest, -0.95 * kAmplitude);
}

// Fourier coefficient over a line of length L: 2 / L * sum h exp(-i q s). A wave of another wave number differs by dq
// and leaks at most A / 4 * 2 * 2 / (dq L), and as much again for its mirror image; sampling 12 times a wavelength
// makes that pi / 3 larger at most.
struct Line {
  ProceduralTexture texture{kAmplitude, kWavelength};
  int count = 200'000;
  double step_m = kWavelength / 12;
  [[nodiscard]] double length() const { return count * step_m; }
  [[nodiscard]] double coefficient(double q_per_m) const {
    std::complex<double> sum = 0;
    for (int i = 0; i < count; ++i) sum += texture.height(onLine(i * step_m)) * std::polar(1.0, -q_per_m * i * step_m);
    return 2 * std::abs(sum) / count;
  }
  [[nodiscard]] double leakage(double q_per_m, int self) const {
    double leak_m = 0;
    for (int i = 0; i < ProceduralTexture::kWaves; ++i) {
      const double q = texture.waveVector(i).dot(kLine);
      for (const double of : {q, -q}) {
        if (i == self && of * q_per_m > 0) continue;
        leak_m += kAmplitude / ProceduralTexture::kWaves * 2 / (std::abs(of - q_per_m) * length());
      }
    }
    return leak_m * std::numbers::pi / 3;
  }
};

TEST(ProceduralTexture, SpectrumIsFourEqualLinesAndNothingElse) {
  const Line line;
  for (int i = 0; i < ProceduralTexture::kWaves; ++i) {
    const double q = std::abs(line.texture.waveVector(i).dot(kLine));
    const double leak = line.leakage(q, i);
    ASSERT_LT(leak, 0.01 * kAmplitude);
    EXPECT_NEAR(line.coefficient(q), kAmplitude / ProceduralTexture::kWaves, leak) << i;
    const double other = 1.013 * q + 11;
    EXPECT_LE(line.coefficient(other), line.leakage(other, -1)) << i;
  }
}

TEST(ProceduralTexture, MeanIsZero) {
  const Line line;
  const double leak = line.leakage(0, -1);
  ASSERT_LT(leak, 0.001 * kAmplitude);
  EXPECT_LE(line.coefficient(0), 2 * leak);
}

// On a plane d is minus the slope of D'^2 / 2. The height is differentiated here by differences of 2 q = 0.2 um, which
// err by q^2 / 6 (2 pi / wavelength)^3 A = 2e-8 of a slope below 1, and by the rounding of 1e-18 m over 2 q, 5e-12.
TEST(ProceduralTexture, PushesDownTheSlopeOfWhatItStores) {
  ProceduralTexture texture(kAmplitude, kWavelength);
  PlaneContact contact(texture);
  const double q = 0.1e-6;
  // texture.hpp: the share falls beyond 2A, so that D' times the bend of h stays below 1.
  const double k_per_m = 2 * std::numbers::pi / kWavelength, most_m = 3 / (kAmplitude * k_per_m * k_per_m);
  const double fall_m = std::sqrt(std::pow(most_m - kAmplitude, 2) - std::pow(2 * kAmplitude, 2));
  for (const Vec3& hip : wander(1000)) {
    const Vec3 flat(hip.x(), hip.y(), 0);
    const double depth_m = -hip.z();
    const double u = std::min(1.0, depth_m / (2 * kAmplitude));
    double share = u * (2 - u), share_per_m = (1 - u) / kAmplitude;
    if (u == 1) {
      const double x = (depth_m - 2 * kAmplitude) / fall_m;
      share = std::pow(1 + x * x, -0.5);
      share_per_m = -x * std::pow(1 + x * x, -1.5) / fall_m;
    }
    const double height_m = texture.height(flat);
    const double raised_m = depth_m + share * height_m;
    const auto slope = [&](const Vec3& way) {
      return (texture.height(flat + q * way) - texture.height(flat - q * way)) / (2 * q);
    };
    const Vec3 d(-raised_m * share * slope(Vec3::UnitX()), -raised_m * share * slope(Vec3::UnitY()),
                 raised_m * (1 + height_m * share_per_m));
    EXPECT_NEAR((contact.at(hip) - hip - d).norm(), 0, 1e-7 * 2e-3);
    EXPECT_NEAR(contact.push.energy_m2, 0.5 * raised_m * raised_m, 1e-20);
  }
}

// A hand feels a slope of one half at most, whatever amplitude is asked for; and nearly that.
TEST(ProceduralTexture, IsNoSteeperThanStated) {
  ProceduralTexture texture(1, kWavelength);
  const double amplitude_m = std::sqrt(3.0) / (4 * std::numbers::pi) * kWavelength;
  EXPECT_NEAR(texture.amplitude(), amplitude_m, 1e-15);
  constexpr double kSteepest = 0.5;
  PlaneContact contact(texture);
  double steepest = 0;
  for (int i = 0; i < 200'000; ++i) {
    const Vec3 hip(0.0371e-3 * i, 0.0193e-3 * i, -2 * amplitude_m);
    const Vec3 d = contact.at(hip) - hip;
    steepest = std::max(steepest, std::hypot(d.x(), d.y()) / d.z());
  }
  EXPECT_LE(steepest, kSteepest);
  EXPECT_GT(steepest, 0.8 * kSteepest);
}

// Along the surface a texture holds the tool by at most K for its bend and K times its slope squared, however deep the
// tool is: differences of d over a nanometre. Without that a deep press is held many times as stiffly, without damping.
TEST(ProceduralTexture, HoldsTheToolAlongTheSurfaceByLittleMoreThanTheStiffness) {
  Seeded random(12);
  double most = 0;
  for (int i = 0; i < 20'000; ++i) {
    const double wavelength_m = random.logBetween(0.3e-3, 5e-3);
    ProceduralTexture texture(random.logBetween(1e-6, 1e-3), wavelength_m);
    const double bend_per_m = texture.amplitude() * std::pow(2 * std::numbers::pi / wavelength_m, 2) / 3;
    const double slope = bend_per_m * wavelength_m / (2 * std::numbers::pi) * std::sqrt(3.0);
    const Vec3 hip(random.between(0, 10e-3), random.between(0, 10e-3), -random.logBetween(1e-6, 20e-3));
    const double angle = random.between(0, std::numbers::pi), q = 1e-9;
    const Vec3 way(std::cos(angle), std::sin(angle), 0);
    PlaneContact contact(texture);
    const Vec3 change = contact.at(hip - q * way) - contact.at(hip + q * way) + 2 * q * way;
    const double stiffness = change.dot(way) / (2 * q);
    ASSERT_LE(stiffness, 1 + slope * slope + 1e-5) << i;
    most = std::max(most, stiffness);
  }
  EXPECT_GT(most, 0.7);
  EXPECT_LE(most, 1 + kSteepestTexture * kSteepestTexture);
}

// D' is 0 where the depth is, never negative and at most 2D, and 1 + h s' is from 0 to 2: so contact begins and ends
// without a step, and never pulls.
TEST(ProceduralTexture, BeginsWithoutAStep) {
  ProceduralTexture texture(kAmplitude, kWavelength);
  PlaneContact contact(texture);
  for (int i = 0; i < 1000; ++i) {
    const double depth_m = 0.2e-3 * i / 1000;
    const Vec3 hip(i * 0.037e-3, 0, -depth_m);
    const double textured_m = contact.at(hip).z() - hip.z();
    EXPECT_GE(textured_m, 0);
    EXPECT_LE(textured_m, 4 * depth_m + 1e-18);
  }
}

TEST(ProceduralTexture, WithoutAmplitudeThereIsNone) {
  ProceduralTexture texture(0, kWavelength);
  PlaneContact contact(texture);
  EXPECT_EQ(contact.at({1e-3, 2e-3, -kDepth}), Vec3(1e-3, 2e-3, 0));
  EXPECT_EQ(contact.at({1e-3, 2e-3, 0}), Vec3(1e-3, 2e-3, 0));
}

// ---- density ----

constexpr double kVoxel = 1e-3;
const Vec3 kSurface(16e-3, 16e-3, 16e-3);  // a sample

class DensityTextureTest : public testing::Test {
 protected:
  // Height of the texture above a point of a level surface.
  double height(std::function<double(const Vec3&)> density, const Vec3& surface_W, double amplitude_m = 0.5e-3,
                double gain = 1) {
    volume_ = millimetreVolume(std::move(density), 32);
    volume_.hold(held_, Vec3i::Zero(), volume_.size);
    DensityTexture texture(amplitude_m, gain, 1000);
    return heightOf(texture, surface_W, amplitude_m);
  }
  // 2A deep, where all of it is felt.
  double heightOf(DensityTexture& texture, const Vec3& surface_W, double amplitude_m = 0.5e-3) {
    PlaneContact contact(texture);
    contact.plane_T.p_W = surface_W;
    contact.window = &held_.window;
    contact.plane_is_felt = true;
    const double side_m = volume_.lattice.smallestSpacing();
    const double depth_m = 2 * std::min(amplitude_m, DensityTexture::kWidest * side_m);
    contact.at(surface_W - depth_m * Vec3::UnitZ());
    return std::sqrt(2 * contact.push.energy_m2) - depth_m;
  }

  AnalyticVolume volume_;
  HeldWindow held_;
};

// Samples are floats of some 1e-3 at most beside the surface: rounding 1e-10.
constexpr double kFloat_m = 1e-9;

// A level surface whose density alternates by +-e from sample to sample along x. A sample's neighbours along x are e
// the other way, the others as here: the mean is e / 3, the departure 2 e / 3. Central differences do not see the
// alternation: the steepness is 1. The smooth field weighs a sample by 3 / 4 along x and its neighbours by 1 / 8 each:
// half of the departure is left.
TEST_F(DensityTextureTest, ReadsTheDepartureFromTheTrend) {
  const double e = 0.05e-3;
  const auto striped = [&](const Vec3& p) {
    return kSurface.z() - p.z() + (std::lround(p.x() / kVoxel) % 2 == 0 ? e : -e);
  };
  EXPECT_NEAR(height(striped, kSurface), e / 3, kFloat_m);
  EXPECT_NEAR(height(striped, kSurface + Vec3(kVoxel, 0, 0)), -e / 3, kFloat_m);
  EXPECT_NEAR(height(striped, kSurface + Vec3(0.5 * kVoxel, 0, 0)), 0, kFloat_m);
  EXPECT_NEAR(height(striped, kSurface, 0.5e-3, 3.0), e, kFloat_m);
}

// On voxels of 1 x 0.5 x 1.6 mm a neighbour weighs one over its distance squared, 1, 4 and 0.390625 of 5.390625: the
// stripes along x depart from their mean by 2 e / 5.390625, of which the smooth field leaves half.
TEST_F(DensityTextureTest, WeighsNeighboursByTheirDistance) {
  const double e = 0.05e-3;
  volume_.lattice.spacing_m = Vec3(1e-3, 0.5e-3, 1.6e-3);
  volume_.size = Vec3i::Constant(32);
  volume_.density = [&](const Vec3& p) {
    return kSurface.z() - p.z() + (std::lround(p.x() / kVoxel) % 2 == 0 ? e : -e);
  };
  volume_.hold(held_, Vec3i::Zero(), volume_.size);
  DensityTexture texture(0.5e-3, 1, 1000);
  EXPECT_NEAR(heightOf(texture, Vec3(16e-3, 8e-3, 16e-3)), e / 5.390625, kFloat_m);
}

// The same density in other units gives the same texture: a departure is a length.
TEST_F(DensityTextureTest, DoesNotDependOnTheUnitOfDensity) {
  const double e = 0.05e-3;
  const auto striped = [&](const Vec3& p) {
    return 3e5 * (kSurface.z() - p.z() + (std::lround(p.x() / kVoxel) % 2 == 0 ? e : -e));
  };
  EXPECT_NEAR(height(striped, kSurface), e / 3, kFloat_m);
}

TEST_F(DensityTextureTest, ALevelFieldHasNone) {
  for (const Vec3& way : wander(10)) {
    EXPECT_NEAR(height([](const Vec3& p) { return kSurface.z() - p.z(); }, kSurface + 3 * way), 0, kFloat_m);
  }
}

// On the top of a ball the four neighbours aside are sqrt(R^2 + h^2) - R = h^2 / (2 R) - h^4 / (8 R^3) below, the two
// others are even about here: h^2 / (3 R), to (h / R)^2 of it, within the 1.5 voxels that the smooth field reaches as
// well. Steepness is 1 to h^2 / (2 R^2).
TEST_F(DensityTextureTest, ASmoothBallReadsAsStated) {
  const double R = 10e-3;
  const double expected_m = kVoxel * kVoxel / (3 * R);
  const double h = height(ball(kSurface - Vec3(0, 0, R), R), kSurface);
  EXPECT_NEAR(h, expected_m, 4 * expected_m * kVoxel * kVoxel / (R * R) + kFloat_m);
}

TEST_F(DensityTextureTest, IsCutOffAtTheAmplitude) {
  const double e = 0.05e-3;
  const auto striped = [&](const Vec3& p) {
    return kSurface.z() - p.z() + (std::lround(p.x() / kVoxel) % 2 == 0 ? e : -e);
  };
  // Of samples that are cut off at +-A in turn, half is left.
  EXPECT_NEAR(height(striped, kSurface, kAmplitude, 1e6), 0.5 * kAmplitude, 1e-17);
  EXPECT_NEAR(height(striped, kSurface + Vec3(kVoxel, 0, 0), kAmplitude, 1e6), -0.5 * kAmplitude, 1e-17);
  // An amplitude that would be too steep for the voxels is made smaller.
  EXPECT_NEAR(height(striped, kSurface, 5e-3, 1e6), 0.5 * DensityTexture::kWidest * kVoxel, 1e-17);
}

// As the procedural texture, whatever the samples are: here as rough as they can be, on voxels of any shape.
TEST_F(DensityTextureTest, HoldsTheToolAlongTheSurfaceByLittleMoreThanTheStiffness) {
  Seeded random(14);
  double most = 0;
  for (int i = 0; i < 60; ++i) {
    volume_ = millimetreVolume([&](const Vec3& p) { return 1e-3 * random.pick(2) + 1e-6 * p.z(); }, 12);
    volume_.lattice.spacing_m = Vec3(random.between(0.3e-3, 1e-3), random.between(0.3e-3, 1e-3), 1e-3);
    volume_.hold(held_, Vec3i::Zero(), volume_.size);
    DensityTexture texture(random.logBetween(1e-6, 1e-3), 1e6, 1000);
    for (int j = 0; j < 60; ++j) {
      const Vec3 at_W = volume_.lattice.toWorld(Vec3::Constant(6) + random.inCube(4));
      const double angle = random.between(0, std::numbers::pi), q = 1e-9;
      const Vec3 way(std::cos(angle), std::sin(angle), 0);
      PlaneContact contact(texture);
      contact.plane_T.p_W = at_W;
      contact.window = &held_.window;
      contact.plane_is_felt = true;
      const Vec3 hip = at_W - random.logBetween(1e-5, 10e-3) * Vec3::UnitZ();
      const Vec3 change = contact.at(hip - q * way) - contact.at(hip + q * way) + 2 * q * way;
      const double stiffness = change.dot(way) / (2 * q);
      // Where the quadratic spline goes over to the next one between both places the change is between theirs.
      ASSERT_LE(stiffness, 1 + kSteepestTexture * kSteepestTexture + 1e-5) << i << " " << j;
      most = std::max(most, stiffness);
    }
  }
  EXPECT_GT(most, 0.3);
}

TEST_F(DensityTextureTest, ThereIsNoneWhereNothingIsKnown) {
  const auto steep = [](const Vec3& p) { return kSurface.z() - p.z() + 1e-3 * std::sin(4e3 * p.x()); };
  ASSERT_NE(height(steep, kSurface + Vec3(0.3e-3, 0, 0)), 0);
  // Beyond the outermost samples it goes on level, so that a face of the volume is no edge of the texture.
  EXPECT_NEAR(height(steep, Vec3(-5e-3, 16e-3, 16e-3)), height(steep, Vec3(0, 16e-3, 16e-3)), 1e-17);
  DensityTexture texture(0.5e-3, 1, 1000);
  held_.window.version = 0;  // not usable
  EXPECT_NEAR(heightOf(texture, kSurface), 0, 1e-17);
  EXPECT_NEAR(height([](const Vec3&) { return 1.0; }, kSurface), 0, 1e-17);  // no gradient
  EXPECT_NEAR(height([](const Vec3& p) { return std::nan("") * p.x(); }, kSurface), 0, 1e-17);
  // Bricks that the surface does not cross have densities in a window, and no gradients.
  ASSERT_NE(height(steep, kSurface + Vec3(0.3e-3, 0, 0)), 0);
  for (Sample& sample : held_.samples) sample.gradient_i = sample.gradient_j = sample.gradient_k = 0;
  DensityTexture without_gradients(0.5e-3, 1, 1000);
  EXPECT_NEAR(heightOf(without_gradients, kSurface + Vec3(0.3e-3, 0, 0)), 0, 1e-17);
}

// A newer window takes the old one's place at once.
TEST_F(DensityTextureTest, ReadsTheWindowOfTheTick) {
  DensityTexture texture(0.5e-3, 1, 1000);
  const auto flat = [](const Vec3& p) { return kSurface.z() - p.z(); };
  ASSERT_NEAR(height(flat, kSurface), 0, kFloat_m);
  EXPECT_NEAR(heightOf(texture, kSurface), 0, kFloat_m);
  volume_.density = ball(kSurface - Vec3(0, 0, 5e-3), 5e-3);
  volume_.hold(held_, Vec3i::Zero(), volume_.size, 2);
  EXPECT_GT(heightOf(texture, kSurface), 0.05e-3);
}

}  // namespace texture_test
}  // namespace palpate
