// SPDX-License-Identifier: Apache-2.0
// Random edits through the engine against the twin.
#include "apps/check/edit_check.hpp"

#include <cmath>
#include <limits>

#include <fmt/format.h>
#include <gtest/gtest.h>

#include "base/error.hpp"
#include "engine/files/volume_file.hpp"

namespace palpate {
namespace edit_check_test {

constexpr auto kQuiet = [](double) {};

TEST(EditCheck, DiffersNowhere) {
  for (const char* name : {"phantom:knot?size=29x25x34&spacing=0.3x0.7x1.1mm&noise=0.05", "phantom:sphere?size=40"}) {
    const Volume volume = loadVolume(name);
    const Check check = checkEdits(volume, {"", 60, 2, {}}, kQuiet);
    EXPECT_EQ(check.name, "edits");
    EXPECT_EQ(check.what, "60 at random, seed 2");
    EXPECT_EQ(check.volume, name);
    EXPECT_TRUE(check.finite);
    EXPECT_GT(check.gpu_seconds, 0);
    EXPECT_GT(check.cpu_seconds, 0);
    EXPECT_EQ(check.compared, static_cast<std::uint64_t>(volume.size().cast<long long>().prod()));
    EXPECT_EQ(check.differing, 0U) << check.voxel.transpose();
    EXPECT_TRUE(check.holds());
    EXPECT_FALSE(check.device.empty());
  }
}

// Edits do change the volume: against a twin that takes none of them most of it differs.
TEST(EditCheck, EditsSomething) {
  const Volume volume = loadVolume("phantom:knot?size=24&noise=0.05");
  const reference::DenseField field = reference::denseField(volume);
  EditCheckRequest request{"", 40, 1, {}};
  const Check edited = checkEdits(volume, field, request, kQuiet);
  EXPECT_TRUE(edited.holds());
  // The same seed on a volume that differs everywhere gives another one, and that is seen.
  const Check other =
      checkEdits(volume, reference::denseField(loadVolume("phantom:knot?size=24&noise=0.05&seed=2")), request, kQuiet);
  EXPECT_FALSE(other.holds());
  EXPECT_GT(other.differing, other.compared / 100);
}

// One edit, so that the changed voxel is still there afterwards or, rarely, overwritten: of several seeds most show it.
TEST(EditCheck, SeesAVoxelChangedByOneUlp) {
  const Volume volume = loadVolume("phantom:knot?size=24&noise=0.05");
  int seen = 0;
  for (unsigned seed = 1; seed <= 5; ++seed) {
    reference::DenseField field = reference::denseField(volume);
    float& value = field.values[field.offset(11, 3, 20)];
    value = std::nextafter(value, 1e9F);
    const Check check = checkEdits(volume, field, {"", 1, seed, {}}, kQuiet);
    if (check.holds()) continue;
    ++seen;
    EXPECT_LE((check.voxel - Vec3i(11, 3, 20)).cwiseAbs().maxCoeff(), 1);
    EXPECT_LE(check.differing, 7U);
  }
  EXPECT_GE(seen, 3);
}

// Bits and finite numbers, among neighbours of 1e30 and denormals, and up to the largest densities of which voxels of
// 1 mm have gradients: 32 * (2 * 5e33) / 1e-3 is 3.2e38, and a float ends at 3.4e38 (checkTouchable).
TEST(EditCheck, TakesRandomBits) {
  EXPECT_TRUE(checkEdits(loadVolume("phantom:random?size=17x2x9"), {"", 30, 1, {}}, kQuiet).holds());
  for (unsigned seed = 1; seed <= 8; ++seed) {
    const Volume volume = loadVolume(fmt::format("phantom:random?size=8x16x24&seed={}", seed));
    const Check check = checkEdits(volume, {"", 100, 1, {}}, kQuiet);
    EXPECT_TRUE(check.holds()) << "seed " << seed << ", voxel " << check.voxel.transpose() << ": " << check.gpu_value;
    std::vector<float> values = volume.toDense();
    for (float& value : values) {
      if (std::abs(value) > 1e29F) value = std::copysign(5e33F, value);
    }
    const Volume larger = Volume::fromDense(volume.size(), volume.lattice(), values, volume.facts());
    EXPECT_TRUE(checkEdits(larger, {"", 100, seed, 0}, kQuiet).holds()) << "seed " << seed;
  }
}

TEST(EditCheck, RefusesAndIsCancelled) {
  const Volume volume = loadVolume("phantom:sphere?size=16");
  std::vector<double> told;
  (void)checkEdits(volume, {"", 4, 1, {}}, [&](double done) { told.push_back(done); });
  EXPECT_EQ(told, (std::vector<double>{0, 0.25, 0.5, 0.75, 1}));
  EXPECT_THROW((void)checkEdits(volume, {"Voodoo", 1, 1, {}}, kQuiet), Error);
  EXPECT_THROW((void)checkEdits(volume, {"", 1, 1, 1e9}, kQuiet), Error);
  EXPECT_THROW(
      (void)checkEdits(volume, {"", 5, 1, {}}, [](double) { throw Error(Error::Code::kCancelled, "x", "y", "z"); }),
      Error);
}

}  // namespace edit_check_test
}  // namespace palpate
