// SPDX-License-Identifier: Apache-2.0
// In a groove between the volume and an object, noise of the samples is felt within a tenth of a newton, and nothing
// jumps, however sharp the groove is.
//
// The volume's surface and the object are planes that meet in a line; the tool goes along it, 2 mm below, at 0.1 m/s
// with 500 N/m. The true VHIP is the point of the line beside the HIP.
#include <algorithm>
#include <cmath>
#include <optional>

#include <fmt/format.h>
#include <gtest/gtest.h>

#include "base/units.hpp"
#include "servo/algorithms/registry.hpp"
#include "servo/objects/shapes.hpp"
#include "support/algorithm_driver.hpp"
#include "support/sampled_volume.hpp"

namespace palpate {
namespace rough_groove_test {

constexpr double kMask = -1;  // in place of a noise

struct Felt {
  double error_N = 0, change_N = 0;  // the largest, of the force and from tick to tick
};

Felt slideAlong(double degrees, double noise, int n, unsigned seed) {
  Seeded random(13 * seed + 1);
  const Vec3 up_W = random.direction(), along_W = random.across(up_W), side_W = up_W.cross(along_W);
  const double half = 0.5 * degrees / kDegreesPerRadian;
  const Vec3 volumes_W = side_W * std::cos(half) + up_W * std::sin(half);
  const Vec3 objects_W = -side_W * std::cos(half) + up_W * std::sin(half);
  const Vec3 middle_W = random.inCube(1e-3);
  Sampling sampling{.size = Vec3i::Constant(64), .noise_m = noise == kMask ? 0 : noise * 1e-3, .seed = seed};
  sampling.lattice = latticeAround(middle_W, sampling.size, Vec3::Constant(1e-3));
  AnalyticVolume volume = sampledOn(sampling, planeSurface(middle_W, volumes_W));
  if (noise == kMask) {
    volume.density = [exact = volume.density](const Vec3& p_W) { return exact(p_W) > 0 ? 0.5e-3 : -0.5e-3; };
  }
  AlgorithmSetup setup;
  setup.parameters = {.stiffness_N_per_m = 500, .damping_Ns_per_m = 0, .plane_renewal_ticks = n};
  setup.objects = {std::make_shared<const PlaneObject>(middle_W, objects_W)};
  const auto hri = makeAlgorithm("hri", std::move(setup));
  AlgorithmDriver driver(*hri, volume, middle_W - along_W * 8e-3 + up_W * 3e-3);
  driver.around_vhip = true;
  Vec3 last_W = Vec3::Zero();
  for (double height_m = 3e-3; height_m > -2e-3; height_m -= 0.1e-3)
    last_W = driver.at(middle_W - along_W * 8e-3 + up_W * height_m).force_W;
  Felt felt;
  for (double way_m = -8e-3; way_m < 8e-3; way_m += 0.1e-3) {
    const TickOutput out = driver.at(middle_W + along_W * way_m - up_W * 2e-3);
    felt.error_N = std::max(felt.error_N, (out.force_W - 500 * 2e-3 * up_W).norm());
    felt.change_N = std::max(felt.change_N, (out.force_W - last_W).norm());
    last_W = out.force_W;
  }
  return felt;
}

// Noise of 0.04 voxel moves one sample's surface by as much; the line where it meets the object moves by 1 / sin of the
// angle of that, 3.6 times at 16 degrees, and by more where the normal errs too. Before, the force jumped by 1.25 N.
TEST(RoughGroove, NoiseIsFeltWithinATenthOfANewton) {
  for (const double degrees : {16.0, 30.0, 60.0, 90.0, 130.0, 164.0}) {
    Felt worst;
    for (unsigned seed = 1; seed <= 6; ++seed) {
      for (const int n : {1, 5}) {
        EXPECT_LE(slideAlong(degrees, 0, n, seed).error_N, 0.004) << degrees;
        const Felt felt = slideAlong(degrees, 0.04, n, seed);
        EXPECT_LE(felt.error_N, 0.1) << degrees << " degrees, seed " << seed << ", n " << n;
        EXPECT_LE(felt.change_N, 0.05) << degrees << " degrees, seed " << seed << ", n " << n;
        worst = {std::max(worst.error_N, felt.error_N), std::max(worst.change_N, felt.change_N)};
      }
    }
    RecordProperty(fmt::format("{} degrees", degrees),
                   fmt::format("{:.3f} N, {:.3f} N a tick", worst.error_N, worst.change_N));
  }
}

// Whatever the samples say, the VHIP goes by the HIP's way and kCatchUp a tick: 500 N/m times 0.1 mm and 0.1 mm; and it
// is pushed by one plane of the two at least.
TEST(RoughGroove, NothingJumpsOnMasksAndMoreNoise) {
  for (const double degrees : {16.0, 30.0, 90.0}) {
    for (const double noise : {0.1, 0.25, kMask}) {
      for (unsigned seed = 1; seed <= 4; ++seed)
        EXPECT_LE(slideAlong(degrees, noise, 1, seed).change_N, 500 * 0.3e-3) << degrees << " " << noise << " " << seed;
    }
  }
}

// A floor of the volume and a wall across it.
struct Corner {
  explicit Corner(unsigned seed) {
    Sampling sampling{.size = Vec3i::Constant(64), .noise_m = 0.25e-3, .seed = seed};
    sampling.lattice = latticeAround(Vec3::Zero(), sampling.size, Vec3::Constant(1e-3));
    volume = stored(sampledOn(sampling, planeSurface(Vec3::Zero(), Vec3(0.6, 0, 0.8))));
    AlgorithmSetup setup;
    setup.parameters = {.stiffness_N_per_m = 500, .damping_Ns_per_m = 0, .plane_renewal_ticks = 1};
    setup.objects = {std::make_shared<const PlaneObject>(Vec3::Zero(), Vec3(-0.6, 0, 0.8))};
    hri = makeAlgorithm("hri", std::move(setup));
    driver.emplace(*hri, volume, Vec3(0, -8e-3, 3e-3), 64);
  }
  std::vector<TickOutput> to(double x_mm, double y_mm, double z_mm, int ticks) {
    return driver->stroke(Vec3(x_mm, y_mm, z_mm) * 1e-3, ticks);
  }
  AnalyticVolume volume;
  std::unique_ptr<Algorithm> hri;
  std::optional<AlgorithmDriver> driver;
};

// A groove that was left is forgotten with the contact: the next one is felt as if it were the first.
TEST(RoughGroove, TheLastOneIsForgotten) {
  Corner used(3), fresh(3);
  used.to(0, -8, -2, 50);
  used.to(0, 8, -2, 160);
  for (Corner* each : {&used, &fresh}) {
    each->to(0, 8, 6, 80);
    each->to(0, 4, 6, 40);
  }
  const auto a = used.to(0, 4, -2, 80), b = fresh.to(0, 4, -2, 80);
  for (std::size_t i = 0; i < a.size(); ++i) ASSERT_EQ(a[i].force_W, b[i].force_W) << i;
  EXPECT_GT(b.back().force_W.norm(), 0.5);
}

// Out of the groove and off the slope before the force has gone over to the volume's alone. What is not gone over never
// pulls, and ends with the depth: the contact ends as softly as the tool goes, 0.1 mm a tick of 500 N/m, doubled by a
// plane that was felt twice as deep.
TEST(RoughGroove, LiftedOutOfBeforeItIsForgottenTheContactEndsSoftly) {
  int lifted = 0;
  for (unsigned seed = 1; seed <= 30; ++seed) {
    Corner corner(seed);
    corner.to(0, -8, -2, 50);
    corner.to(0, 0, -2, 80);
    corner.to(-1.5, 0, -0.3, 25);
    Vec3 last_W = Vec3::Zero();
    bool was_in_contact = true;
    for (const TickOutput& out : corner.to(-1.5 + 0.6 * 8, 0, -0.3 + 0.8 * 8, 80)) {
      ASSERT_GE(out.force_W.dot(Vec3(0.6, 0, 0.8)), -1e-12) << seed;
      if (was_in_contact && !out.in_contact) {
        ++lifted;
        EXPECT_LE(last_W.norm(), 2 * 500 * 0.1e-3 + 1e-9) << seed;
      }
      was_in_contact = out.in_contact;
      last_W = out.force_W;
    }
  }
  EXPECT_GE(lifted, 25);
}

// From the groove up the volume's slope, where the wall is soon far away: the force goes over to the one of the volume
// alone by no more in a tick than on the slope without any wall.
TEST(RoughGroove, IsLeftWithoutAJump) {
  for (unsigned seed = 1; seed <= 8; ++seed) {
    Corner corner(seed);
    Vec3 last_W = corner.to(0, -8, -2, 50).back().force_W;
    double change_N = 0;
    const auto follow = [&](const std::vector<TickOutput>& outs) {
      for (const TickOutput& out : outs) {
        change_N = std::max(change_N, (out.force_W - last_W).norm());
        last_W = out.force_W;
      }
    };
    follow(corner.to(0, 0, -2, 80));
    follow(corner.to(-8, 4, 4, 110));
    EXPECT_LE(change_N, 500 * 0.5e-3) << seed;
    EXPECT_GT(last_W.dot(Vec3(0.6, 0, 0.8)), 0.9 * last_W.norm()) << seed;
  }
}

}  // namespace rough_groove_test
}  // namespace palpate
