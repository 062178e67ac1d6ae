// SPDX-License-Identifier: Apache-2.0
// The gradient kernel against its CPU twin, whole volumes, bit for bit.
#include "apps/check/gradient_check.hpp"

#include <algorithm>
#include <cctype>
#include <cmath>
#include <limits>

#include <gmock/gmock.h>

#include "base/error.hpp"
#include "engine/files/volume_file.hpp"
#include "engine/phantoms/phantom_spec.hpp"

namespace palpate {
namespace gradient_check_test {

void expectEqualBits(const Volume& volume) {
  const Check check = checkGradient(volume, GradientCheckRequest{}, [](double) {});
  EXPECT_EQ(check.compared, 4ULL * static_cast<std::uint64_t>(volume.size().cast<long long>().prod()));
  EXPECT_EQ(check.differing, 0U) << check.component << " of voxel " << check.voxel.transpose() << ": GPU "
                                 << check.gpu_value << ", CPU " << check.cpu_value;
  EXPECT_EQ(check.largest_ulp, 0U);
  EXPECT_FALSE(check.device.empty());
}

class GradientCheckOf : public testing::TestWithParam<std::string> {};

TEST_P(GradientCheckOf, DiffersNowhere) {
  expectEqualBits(loadVolume(GetParam()));
}

// Odd sizes, so that border bricks are cut along every axis, and voxels that are no cubes; noise, so that no brick is
// constant.
std::vector<std::string> everyPhantom() {
  std::vector<std::string> volumes;
  for (const PhantomKind& kind : phantomKinds()) {
    volumes.push_back("phantom:" + kind.name + "?size=37x29x43");
    volumes.push_back("phantom:" + kind.name + "?size=19x33x21&spacing=0.3x0.7x1.9mm&noise=0.05");
  }
  return volumes;
}

// Ordinary values, denormals, +-1e-30, +-1e30 and both zeros, at sizes around those of a brick.
std::vector<std::string> randomVolumes() {
  std::vector<std::string> volumes;
  for (const char* size : {"2", "3", "7", "8", "9", "16", "17", "2x8x65", "65x2x9", "31x30x29"}) {
    volumes.push_back(std::string("phantom:random?size=") + size);
  }
  volumes.emplace_back("phantom:random?size=23&seed=2&spacing=1um");   // large gradients: some overflow
  volumes.emplace_back("phantom:random?size=23&seed=3&spacing=900m");  // small ones: some underflow
  return volumes;
}

std::string plainName(const testing::TestParamInfo<std::string>& volume) {
  std::string name = volume.param.substr(8);
  std::replace_if(
      name.begin(), name.end(), [](char c) { return std::isalnum(static_cast<unsigned char>(c)) == 0; }, '_');
  return name;
}

INSTANTIATE_TEST_SUITE_P(EveryPhantom, GradientCheckOf, testing::ValuesIn(everyPhantom()), plainName);
INSTANTIATE_TEST_SUITE_P(Random, GradientCheckOf, testing::ValuesIn(randomVolumes()), plainName);

// Differences of neighbours that overflow to infinity, and products that underflow, must be the same ones on both
// sides.
TEST(GradientCheck, LargestAndSmallestFloatsDifferNowhere) {
  using Limits = std::numeric_limits<float>;
  const float extremes[] = {Limits::max(),        -Limits::max(), Limits::min(), -Limits::min(),
                            Limits::denorm_min(), 0.0F,           -0.0F};
  std::vector<float> values;
  for (std::size_t n = 0; n < 11 * 10 * 9; ++n) values.push_back(extremes[n * n % std::size(extremes)]);
  const Lattice lattice{Vec3::Zero(), Mat3::Identity(), Vec3(1e-3, 2e-3, 0.5e-3)};
  expectEqualBits(Volume::fromDense({11, 10, 9}, lattice, values, {}));
}

// One voxel of the twin is the next float. Its density differs, and the differences that it takes part in: those of its
// two neighbours along each axis, or, at a corner, its own too and one neighbour's, one-sided. Voxels are whole numbers
// from 1024 to 2047, of one binade: their differences are exact in float, so that every one of these changes.
class GradientCheckSees : public testing::Test {
 protected:
  [[nodiscard]] static Volume exactVolume() {
    std::vector<float> values;
    for (int n = 0; n < 12 * 11 * 10; ++n) values.push_back(static_cast<float>(n * 7919 % 1024) + 1024);
    return Volume::fromDense({12, 11, 10}, {Vec3::Zero(), Mat3::Identity(), Vec3(0.5, 0.5, 0.5)}, values, {});
  }
  [[nodiscard]] static Check checkWithChanged(const Vec3i& voxel) {
    const Volume volume = exactVolume();
    reference::DenseField field = reference::denseField(volume);
    float& value = field.values[field.offset(voxel.x(), voxel.y(), voxel.z())];
    value = std::nextafter(value, std::numeric_limits<float>::max());
    return checkGradient(volume, field, GradientCheckRequest{}, [](double) {});
  }
};

TEST_F(GradientCheckSees, NoDifferenceWhereThereIsNone) {
  expectEqualBits(exactVolume());
}

TEST_F(GradientCheckSees, AVoxelChangedByOneUlp) {
  const Check check = checkWithChanged({5, 6, 7});
  EXPECT_EQ(check.differing, 1U + 6U);
  EXPECT_GE(check.largest_ulp, 1U);
  EXPECT_LE((check.voxel - Vec3i(5, 6, 7)).cwiseAbs().sum(), 1);
  EXPECT_FALSE(check.component.empty());
  EXPECT_NE(check.gpu_value, check.cpu_value);
}

TEST_F(GradientCheckSees, ACornerVoxelInAPartlyFilledBrick) {
  EXPECT_EQ(checkWithChanged({11, 10, 9}).differing, 1U + 3U + 3U);
  EXPECT_EQ(checkWithChanged({0, 0, 0}).differing, 1U + 3U + 3U);
}

TEST(GradientCheck, TellsHowFarItIsAndCanBeCancelled) {
  const Volume volume = loadVolume("phantom:random?size=24");
  double last = -1;
  (void)checkGradient(volume, GradientCheckRequest{}, [&](double done) {
    EXPECT_GE(done, 0);
    EXPECT_LE(done, 1);
    last = done;
  });
  EXPECT_GE(last, 0);
  // 257 bricks in a row: the last but one is told. An operator that smooths takes half of the time for that.
  const Volume row = loadVolume("phantom:random?size=8x8x2056");
  for (const auto& [name, share] : {std::pair("central", 0.0), {"gaussian:1.2", 0.5}}) {
    std::vector<double> told = {0};
    (void)checkGradient(row, {.gradient = gradientOperator(name)}, [&](double done) { told.push_back(done); });
    EXPECT_TRUE(std::is_sorted(told.begin(), told.end())) << name;
    EXPECT_NEAR(told.back(), share + (1 - share) * 256 / 257, 1e-12) << name;
    EXPECT_THAT(told, testing::Contains(share)) << name;
  }
  EXPECT_THROW((void)checkGradient(volume, GradientCheckRequest{},
                                   [](double) { throw Error(Error::Code::kCancelled, "x", "y", "z"); }),
               Error);
}

TEST(GradientCheck, SaysWhatItChecked) {
  GradientCheckRequest request{.gradient = gradientOperator("sobel"), .bound_ulp = 3};
  const Check check = checkGradient(loadVolume("phantom:box?size=8"), request, [](double) {});
  EXPECT_EQ(check.name, "gradient");
  EXPECT_EQ(check.what, "sobel, floats");
  EXPECT_EQ(check.volume, "phantom:box?size=8");
  EXPECT_EQ(check.bound_ulp, 3U);
  EXPECT_GT(check.gpu_seconds, 0);
  EXPECT_GT(check.cpu_seconds, 0);
  request.format.half = true;
  EXPECT_EQ(checkGradient(loadVolume("phantom:box?size=8"), request, [](double) {}).what, "sobel, halves");
}

TEST(GradientCheck, RefusesADeviceThatIsNotThere) {
  EXPECT_THROW((void)checkGradient(loadVolume("phantom:box?size=8"), {.gpu = "Voodoo"}, [](double) {}), Error);
}

}  // namespace gradient_check_test
}  // namespace palpate
