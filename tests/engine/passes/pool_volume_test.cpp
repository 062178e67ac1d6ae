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

TEST_F(PoolVolume, KeepsAccountOfItsBricks) {
  const auto expectPage = [&](std::size_t brick, std::uint32_t slot, float constant) {
    EXPECT_EQ(pool_.page(brick).slot, slot) << brick;
    EXPECT_EQ(pool_.page(brick).constant, constant) << brick;
  };
  ASSERT_EQ(pool_.brickCount(), 18U);
  EXPECT_EQ(pool_.storedBricks(), 17U);
  expectPage(0, NO_SLOT, -1);
  expectPage(4, 3, 0);
  pool_.makeConstant(4, 2.5F);
  expectPage(4, NO_SLOT, 2.5F);
  EXPECT_EQ(pool_.storedBricks(), 16U);
  pool_.makeConstant(4, 3.5F);  // which it is already
  expectPage(4, NO_SLOT, 3.5F);
  EXPECT_EQ(pool_.storedBricks(), 16U);
  EXPECT_EQ(pool_.stalePages(), 2U);
  EXPECT_THAT(pool_.takeStalePages(), testing::ElementsAre(4, 4));
  EXPECT_EQ(pool_.stalePages(), 0U);
  pool_.reserve(2);
  EXPECT_EQ(pool_.store(4), 3U);
  expectPage(4, 3, 0);
  EXPECT_EQ(pool_.store(0), 17U);
  expectPage(0, 17, 0);
  EXPECT_EQ(pool_.storedBricks(), 18U);
  pool_.empty(0);
  expectPage(0, NO_SLOT, 0);
  EXPECT_EQ(pool_.storedBricks(), 17U);
  pool_.setConstant(0, 7);
  float value = 0;
  EXPECT_TRUE(pool_.readBrick(transfer_, 0, &value));
  EXPECT_EQ(value, 7);
}

// A pool like another begins as nothing but zeros. New pages give slots in order, whatever they were.
TEST_F(PoolVolume, TakesOtherPages) {
  BrickPool other(gpu_, transfer_, pool_, "other");
  EXPECT_EQ(other.storedBricks(), 0U);
  EXPECT_EQ(densitiesOf(other, transfer_), std::vector<float>(std::size_t{19} * 10 * 17));
  other.reserve(2);
  (void)other.store(2);
  (void)other.store(6);
  other.makeConstant(6, 1);
  std::vector<layout::BrickPage> pages(18);
  for (std::size_t i = 0; i < pages.size(); ++i) pages[i] = {NO_SLOT, 0.5F * static_cast<float>(i)};
  pages[3] = {9, 4};
  pages[1] = {9, 4};
  pages[17] = {9, 4};
  other.assign(transfer_, pages);
  EXPECT_EQ(other.storedBricks(), 3U);
  EXPECT_EQ(other.stalePages(), 0U);
  for (std::size_t i = 0; i < pages.size(); ++i) {
    const bool stored = i == 1 || i == 3 || i == 17;
    EXPECT_EQ(other.page(i).slot, !stored ? NO_SLOT : i == 1 ? 0U : i == 3 ? 1U : 2U) << i;
    EXPECT_EQ(other.page(i).constant, stored ? 0 : 0.5F * static_cast<float>(i)) << i;
  }
}

// 17 x 16 x 16 bricks: more than are uploaded at once.
TEST(BrickPool, UploadsAllItsParts) {
  const Volume volume =
      makeField({130, 128, 128}, [](int i, int j, int k) { return static_cast<float>((k * 128 + j) * 130 + i); });
  gpu::Gpu gpu({});
  gpu::Transfer transfer(gpu);
  const BrickPool pool(gpu, transfer, volume);
  EXPECT_EQ(pool.storedBricks(), 17U * 16U * 16U);
  EXPECT_EQ(densitiesOf(pool, transfer) == volume.toDense(), true);
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
