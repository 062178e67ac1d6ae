// SPDX-License-Identifier: Apache-2.0
#include "engine/passes/pool_volume.hpp"

#include <cmath>

#include <gmock/gmock.h>

#include "base/error.hpp"
#include "engine/gpu/gpu.hpp"
#include "test_fields.hpp"

namespace palpate {
namespace pool_volume_test {

using testing::HasSubstr;

class PoolVolume : public testing::Test {
 protected:
  // Numbers that no two voxels share, but for a constant brick.
  const Volume volume_ = makeField({19, 10, 17}, [](int i, int j, int k) {
    return i < 8 && j < 8 && k < 8 ? -1.0F : static_cast<float>((k * 10 + j) * 19 + i);
  });
  gpu::Gpu gpu_{{}};
  gpu::Transfer transfer_{gpu_};
  BrickPool pool_{gpu_, transfer_, volume_};
};

TEST_F(PoolVolume, BringsBackWhatWasPutThere) {
  ASSERT_LT(pool_.storedBricks(), pool_.brickCount());
  EXPECT_EQ(densitiesOf(pool_, transfer_), volume_.toDense());
  VolumeFacts facts;
  facts.source = "given";
  const Volume back = volumeOf(pool_, transfer_, facts);
  EXPECT_EQ(back.toDense(), volume_.toDense());
  EXPECT_EQ(back.facts().source, "given");
  EXPECT_EQ(back.storedBricks(), volume_.storedBricks());
}

// What was loaded is finite: the message must not send anybody to look for the fault in the file.
TEST_F(PoolVolume, SaysThatWhatWasComputedIsNotFinite) {
  auto* densities = static_cast<float*>(pool_.slab(0).mapped());
  if (densities == nullptr) GTEST_SKIP() << "the device's memory is not mapped, so the test cannot change it";
  densities[BrickPool::place(pool_.page(1).slot).offset_bytes / sizeof(float)] = NAN;  // the first voxel of brick 1
  EXPECT_TRUE(std::isnan(densitiesOf(pool_, transfer_)[8]));
  VolumeFacts facts;
  facts.source = "scan.nrrd";
  try {
    (void)volumeOf(pool_, transfer_, facts);
    ADD_FAILURE() << "no error";
  } catch (const Error& error) {
    EXPECT_EQ(error.code(), Error::Code::kBadInput);
    EXPECT_EQ(error.input(), "the field computed from scan.nrrd");
    EXPECT_THAT(error.reason(), HasSubstr("1 of its 3230 voxels are NaN or infinite, the first at index (8, 0, 0)"));
    EXPECT_THAT(error.remedy(), HasSubstr("scale them down"));
  }
}

}  // namespace pool_volume_test
}  // namespace palpate
