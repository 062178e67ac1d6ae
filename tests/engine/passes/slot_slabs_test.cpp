// SPDX-License-Identifier: Apache-2.0
// Slots that come and go, slabs that grow, a budget that ends it.
#include "engine/passes/slot_slabs.hpp"

#include <numeric>
#include <set>
#include <span>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "base/error.hpp"
#include "engine/field/volume.hpp"
#include "engine/gpu/transfer.hpp"
#include "engine/passes/sample_store.hpp"

namespace palpate {
namespace slot_slabs_test {

constexpr std::size_t kSlotBytes = 64;

SlotSlabs::Shape shape(std::size_t max_slabs = 0) {
  return {"test", kSlotBytes, 16, max_slabs};
}

TEST(SlotSlabs, GrowsByDoublingAndKeepsWhatItHolds) {
  gpu::Gpu gpu({});
  gpu::Transfer transfer(gpu);
  SlotSlabs slabs(gpu, shape(), 3, makeGpuBudget());
  EXPECT_EQ(slabs.bytes(), 3 * kSlotBytes);
  std::set<std::uint32_t> taken;
  std::vector<float> content(3 * kSlotBytes / 4);
  for (std::size_t i = 0; i < content.size(); ++i) content[i] = static_cast<float>(i);
  for (int i = 0; i < 3; ++i) taken.insert(slabs.take());
  transfer.upload(std::as_bytes(std::span(content)), slabs.slab(0));
  EXPECT_EQ(slabs.free(), 0U);
  slabs.reserve(1);
  EXPECT_EQ(slabs.bytes(), 6 * kSlotBytes);
  std::vector<float> kept(content.size());
  transfer.download(slabs.slab(0), std::as_writable_bytes(std::span(kept)));
  EXPECT_EQ(kept, content);
  slabs.reserve(40);  // the first slab becomes whole, others follow
  EXPECT_GE(slabs.slabCount(), 3U);
  for (int i = 0; i < 40; ++i) taken.insert(slabs.take());
  EXPECT_EQ(taken.size(), 43U);  // no slot twice
  EXPECT_EQ(slabs.inUse(), 43U);
  transfer.download(slabs.slab(0), std::as_writable_bytes(std::span(kept)));
  EXPECT_EQ(kept, content);
}

TEST(SlotSlabs, GivesReleasedSlotsAgain) {
  gpu::Gpu gpu({});
  SlotSlabs slabs(gpu, shape(), 4, makeGpuBudget());
  for (int i = 0; i < 4; ++i) (void)slabs.take();
  slabs.release(2);
  EXPECT_EQ(slabs.inUse(), 3U);
  slabs.reserve(1);
  EXPECT_EQ(slabs.bytes(), 4 * kSlotBytes);
  EXPECT_EQ(slabs.take(), 2U);
}

TEST(SlotSlabs, GivesASlotOfTheSlabThatIsAskedFor) {
  gpu::Gpu gpu({});
  SlotSlabs slabs(gpu, shape(), 40, makeGpuBudget());
  for (int i = 0; i < 40; ++i) (void)slabs.take();
  slabs.release(3);   // slab 0
  slabs.release(20);  // slab 1
  slabs.release(39);  // slab 2
  EXPECT_EQ(slabs.take(1), 20U);
  EXPECT_EQ(slabs.take(0), 3U);
  EXPECT_EQ(slabs.take(0), 39U);  // none is left there
  EXPECT_EQ(slabs.inUse(), 40U);
}

TEST(SlotSlabs, GrowsByWhatIsAskedUntilASlotIsTaken) {
  gpu::Gpu gpu({});
  SlotSlabs slabs(gpu, shape(), 4, makeGpuBudget());
  slabs.reserve(5);
  EXPECT_EQ(slabs.bytes(), 5 * kSlotBytes);
  (void)slabs.take();
  slabs.reserve(5);
  EXPECT_EQ(slabs.bytes(), 10 * kSlotBytes);
}

TEST(SlotSlabs, BeginsAnewWhenAllAreReleased) {
  gpu::Gpu gpu({});
  SlotSlabs slabs(gpu, shape(), 20, makeGpuBudget());
  for (int i = 0; i < 18; ++i) (void)slabs.take();
  slabs.release(3);
  slabs.release(17);
  EXPECT_EQ(slabs.inUse(), 16U);
  EXPECT_EQ(slabs.free(), 4U);
  slabs.releaseAll();
  EXPECT_EQ(slabs.inUse(), 0U);
  EXPECT_EQ(slabs.free(), 20U);
  for (std::uint32_t slot = 0; slot < 20; ++slot) EXPECT_EQ(slabs.take(), slot);
  EXPECT_EQ(slabs.bytes(), 20 * kSlotBytes);
}

TEST(SampleStore, TellsWhichBricksHaveSamples) {
  gpu::Gpu gpu({});
  SampleStore store(gpu, 9, {7, 2, 5});
  EXPECT_THAT(store.bricks(), testing::ElementsAre(2, 5, 7));
  EXPECT_EQ(store.place(7).slot, 0U);
  EXPECT_EQ(store.place(2).slot, 1U);
  EXPECT_EQ(store.place(5).slot, 2U);
  store.remove(2);
  EXPECT_THAT(store.bricks(), testing::ElementsAre(5, 7));
  EXPECT_EQ(store.place(2).slot, NO_SLOT);
  EXPECT_EQ(store.brickCount(), 2U);
  store.add(8);
  EXPECT_EQ(store.place(8).slot, 1U);
}

// Each full slab keeps a sixteenth free, where the next bricks of its region find room; a budget that allows no spare
// still holds all.
TEST(SampleStore, KeepsRoomBesideItsBricks) {
  gpu::Gpu gpu({});
  constexpr std::size_t kBricks = BRICKS_PER_SAMPLE_SLAB + 100;
  std::vector<std::uint32_t> bricks(kBricks);
  std::iota(bricks.begin(), bricks.end(), 0U);
  SampleStore store(gpu, 2 * kBricks, bricks);
  EXPECT_EQ(store.brickCount(), kBricks);
  EXPECT_EQ(store.bytes(), (kBricks + BRICKS_PER_SAMPLE_SLAB / 16) * kBrickVoxels * 16);
  EXPECT_EQ(store.place(0).slab, 0U);
  EXPECT_EQ(store.place(BRICKS_PER_SAMPLE_SLAB / 16 * 15).slab, 1U);
  store.add(kBricks, 5);
  EXPECT_EQ(store.place(kBricks).slab, 0U);
  store.reserve(1);
  store.add(kBricks + 1, kBricks - 1);
  EXPECT_EQ(store.brickCount(), kBricks + 2);
  SampleStore tight(gpu, 2 * kBricks, bricks, makeGpuBudget(kBricks * kBrickVoxels * 16));
  EXPECT_EQ(tight.brickCount(), kBricks);
  EXPECT_EQ(tight.bytes(), kBricks * kBrickVoxels * 16);
  EXPECT_EQ(tight.place(BRICKS_PER_SAMPLE_SLAB - 1).slab, 0U);
  bricks.resize(BRICKS_PER_SAMPLE_SLAB);  // just one slab full: there is no other region to keep apart
  const SampleStore full(gpu, kBricks, bricks);
  EXPECT_EQ(full.slabCount(), 1U);
  EXPECT_EQ(full.bytes(), bricks.size() * kBrickVoxels * 16);
}

TEST(SlotSlabs, RefusesMoreThanTheBudgetAndStaysUsable) {
  gpu::Gpu gpu({});
  const auto budget = makeGpuBudget(20 * kSlotBytes);
  {
    SlotSlabs slabs(gpu, shape(), 8, budget);
    EXPECT_EQ(budget->used_bytes, 8 * kSlotBytes);
    try {
      slabs.reserve(21);
      FAIL() << "it fitted";
    } catch (const Error& error) {
      EXPECT_EQ(error.code(), Error::Code::kOutOfMemory);
      EXPECT_NE(std::string(error.what()).find("budget"), std::string::npos);
    }
    EXPECT_EQ(slabs.bytes(), 8 * kSlotBytes);
    slabs.reserve(20);  // all of it, although doubling would take more
    EXPECT_EQ(budget->leftBytes(), 0U);
    EXPECT_THROW(SlotSlabs(gpu, shape(), 1, budget), Error);
    EXPECT_EQ(budget->used_bytes, 20 * kSlotBytes);
  }
  EXPECT_EQ(budget->used_bytes, 0U);
}

// Densities must not take by doubling what samples will need a moment later.
TEST(SlotSlabs, DoublesOnlyWhereHalfOfTheBudgetIsLeftForOthers) {
  gpu::Gpu gpu({});
  const auto budget = makeGpuBudget(30 * kSlotBytes);
  SlotSlabs slabs(gpu, shape(), 10, budget);
  for (int i = 0; i < 10; ++i) (void)slabs.take();
  slabs.reserve(1);  // ten more are half of what is left; the slab ends at 16
  EXPECT_EQ(slabs.bytes(), 16 * kSlotBytes);
  for (int i = 0; i < 6; ++i) (void)slabs.take();
  slabs.reserve(1);
  EXPECT_EQ(slabs.bytes(), 17 * kSlotBytes);
  EXPECT_EQ(budget->leftBytes(), 13 * kSlotBytes);
}

TEST(SlotSlabs, RefusesMoreThanItsSlabs) {
  gpu::Gpu gpu({});
  SlotSlabs slabs(gpu, shape(2), 1, makeGpuBudget());
  slabs.reserve(32);
  EXPECT_THROW(slabs.reserve(33), Error);
  EXPECT_EQ(slabs.free(), 32U);
  const auto budget = makeGpuBudget();
  EXPECT_THROW(SlotSlabs(gpu, shape(2), 33, budget), Error);
  EXPECT_EQ(budget->used_bytes, 0U);  // what it had taken by then is given back
}

}  // namespace slot_slabs_test
}  // namespace palpate
