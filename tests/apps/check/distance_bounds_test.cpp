// SPDX-License-Identifier: Apache-2.0
// Distances held to the nearest voxel across: on random fields, on every band and all sorts of voxels, and on real
// scans. Noise is the hardest: no surface point is like its neighbour, and no tangent plane stands for anything.
#include "apps/check/distance_bounds.hpp"

#include <cstdlib>
#include <filesystem>
#include <random>

#include <gtest/gtest.h>

#include "apps/check/check_all.hpp"
#include "apps/check/filter_check.hpp"
#include "engine/files/volume_file.hpp"
#include "engine/reference/filter.hpp"
#include "tests/support/scans.hpp"

namespace palpate {
namespace distance_bounds_test {

constexpr auto kQuiet = [](double) {};

Volume noise(const Vec3i& size, const Vec3& spacing_m, double inside_share, std::mt19937& random) {
  std::vector<float> values(static_cast<std::size_t>(size.prod()));
  std::uniform_real_distribution<float> uniform(0, 1);
  const auto share = static_cast<float>(inside_share);
  // Values next to the isovalue, which is 1 - share, and values far above and below.
  for (float& value : values) {
    const float place = uniform(random);
    value = uniform(random) < 0.3F ? (place > 1 - share ? 50.0F : -50.0F) : place;
  }
  return Volume::fromDense(size, {Vec3::Zero(), Mat3::Identity(), spacing_m}, values, {});
}

Check boundsOf(const std::vector<Check>& checks) {
  for (const Check& check : checks) {
    if (check.name == "distance") return check;
  }
  ADD_FAILURE() << "no check of the distance itself";
  return {};
}

TEST(DistanceBounds, HoldOnNoise) {
  std::mt19937 random(5);
  std::uniform_real_distribution<double> stretch(1, 4);
  for (int round = 0; round < 6; ++round) {
    const Vec3 spacing_m = 0.4e-3 * Vec3(round % 3 == 0 ? 1 : stretch(random), round % 3 == 1 ? 1 : stretch(random),
                                         round % 3 == 2 ? 1 : stretch(random));
    const double share = round % 2 == 0 ? 0.004 : 0.2;
    const Vec3i size(20 + round % 5, 27 - 3 * round, 11 + 3 * round);
    const Volume volume = noise(size, spacing_m, share, random);
    const std::string chain = "distance:" + std::to_string(1 + round % 6);
    const auto checks = checkFilters(volume, {"", {chain}, static_cast<float>(1 - share)}, kQuiet);
    EXPECT_TRUE(allHold(checks)) << spacing_m.transpose() << "\n" << checkTable(checks);
    EXPECT_EQ(boundsOf(checks).compared, static_cast<std::uint64_t>(size.prod()));
  }
}

// The longest part of the check tells how far it is, slice by slice, to its end.
TEST(DistanceBounds, TellTheirProgress) {
  std::mt19937 random(6);
  const Volume volume = noise({24, 24, 24}, Vec3::Constant(1e-3), 0.2, random);
  std::vector<double> told = {0};
  const auto checks = checkFilters(volume, {"", {"distance:3"}, 0.8F}, [&](double done) { told.push_back(done); });
  EXPECT_TRUE(allHold(checks));
  double largest_step = 0;
  for (std::size_t i = 1; i < told.size(); ++i) {
    EXPECT_GE(told[i], told[i - 1]);
    largest_step = std::max(largest_step, told[i] - told[i - 1]);
  }
  EXPECT_LT(largest_step, 0.3);
  EXPECT_NEAR(told.back(), 1, 1e-9);
}

// Whole where it is small, else its middle.
TEST(DistanceBounds, HoldOnScans) {
  const auto scans = realScans();
  if (scans.empty()) GTEST_SKIP() << kNoScans;
  for (const auto& scan : scans) {
    const bool small = std::filesystem::file_size(scan) < 500000;
    const Volume volume = cropped(loadVolume(scan.string()), small ? 1000 : 40);
    const auto checks = checkFilters(volume, {"", {"distance:6"}, {}}, kQuiet);
    EXPECT_TRUE(allHold(checks)) << checkTable(checks);
  }
}

// One voxel inside, and one at the isovalue, which is outside. The next one outside may be one edge off, 1 mm, and by
// rounding 12 2^-24 of that and the diagonal: some 2e-9 m.
TEST(DistanceBounds, AreTightToTheRounding) {
  std::vector<float> values(std::size_t{5} * 4 * 3, 0);
  values[0] = 2;
  values[5 * 4 * 3 - 1] = 0.5F;
  const Vec3 spacing_m(1e-3, 1.5e-3, 1.2e-3);
  const Volume volume = Volume::fromDense({5, 4, 3}, {Vec3::Zero(), Mat3::Identity(), spacing_m}, values, {});
  const auto steps = lowerFilters(filterChain("distance:3"), spacing_m, 0.5F);
  const reference::DenseField densities = reference::denseField(volume);
  reference::DenseField distance = reference::applyFilters(densities, steps);
  std::vector<double> told;
  const auto holds = [&] {
    Check check;
    told.clear();
    compareWithNearestAcross(check, distance, densities, steps, [&](double done) { told.push_back(done); });
    EXPECT_EQ(check.compared, 60U);
    return check.holds();
  };
  EXPECT_TRUE(holds());
  // After each slice of the search, and of the comparison.
  ASSERT_EQ(told.size(), 6U);
  for (std::size_t n = 0; n < 6; ++n) EXPECT_DOUBLE_EQ(told[n], static_cast<double>(n + 1) / 6);
  EXPECT_LE(distance.values.back(), 0);
  distance.values[1] = static_cast<float>(-1e-3 - 1e-9);
  EXPECT_TRUE(holds());
  distance.values[1] = static_cast<float>(-1e-3 - 1e-8);
  EXPECT_FALSE(holds());
}

// A voxel moved beyond either bound, or to the other side, is seen; within them nothing is.
TEST(DistanceBounds, SeeOneVoxelBeyondThem) {
  std::mt19937 random(6);
  const Volume volume = noise({14, 12, 13}, Vec3(1e-3, 1.5e-3, 1.2e-3), 0.01, random);
  const auto steps = lowerFilters(filterChain("distance:5"), volume.lattice().spacing_m, 0.99F);
  const reference::DenseField densities = reference::denseField(volume);
  reference::DenseField distance = reference::applyFilters(densities, steps);
  const auto holds = [&] {
    Check check;
    compareWithNearestAcross(check, distance, densities, steps, kQuiet);
    return check.holds();
  };
  EXPECT_TRUE(holds());
  const double diagonal_m = volume.lattice().spacing_m.norm();
  for (const std::size_t n : {0UL, 800UL, 1500UL}) {
    const float before = distance.values[n];
    const float sign = densities.values[n] > 0.99F ? 1.0F : -1.0F;
    distance.values[n] = -sign * 1e-3F;
    EXPECT_FALSE(holds()) << n;
    distance.values[n] = before + sign * static_cast<float>(1.001 * diagonal_m);
    EXPECT_FALSE(holds()) << n;
    distance.values[n] = before - sign * static_cast<float>(1.001 * diagonal_m);
    EXPECT_FALSE(holds()) << n;
    distance.values[n] = before;
  }
  EXPECT_TRUE(holds());
}

}  // namespace distance_bounds_test
}  // namespace palpate
