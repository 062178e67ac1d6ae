// SPDX-License-Identifier: Apache-2.0
#include "engine/passes/sample_store.hpp"

#include "base/error.hpp"
#include "engine/field/volume.hpp"
#include "servo/window/sample_window.hpp"  // the size of a sample as floats

namespace palpate {

static_assert(sizeof(Sample) == 16, "a uvec4 of shaders/sample_code.layout.h");

SampleStore::SampleStore(gpu::Gpu& gpu, std::size_t brick_count, const std::vector<std::uint32_t>& bricks,
                         std::shared_ptr<GpuBudget> budget, const SampleFormat& format)
    : format_(format),
      slabs_(gpu, {"samples", kBrickVoxels * format.bytesAVoxel(), format.bricksASlab(), 0}, bricks.size(),
             std::move(budget)),
      slot_of_brick_(brick_count, NO_SLOT) {
  const std::size_t spare = spareOf(bricks.size());
  std::vector<std::uint32_t> kept_free;
  for (const std::uint32_t brick : bricks) {
    if (slabs_.inUse() % format_.bricksASlab() + spare == format_.bricksASlab()) {
      for (std::size_t n = 0; n < spare; ++n) kept_free.push_back(slabs_.take());
    }
    add(brick);
  }
  for (const std::uint32_t slot : kept_free) slabs_.release(slot);
}

// Slots of each slab that are kept free.
std::size_t SampleStore::spareOf(std::size_t bricks) {
  const std::size_t slots = format_.bricksASlab();
  if (bricks <= slots) return 0;
  const std::size_t spare = slots / 16;
  try {
    slabs_.reserve(bricks + bricks / (slots - spare) * spare);
  } catch (const Error&) {  // spare slots are optional
    return 0;
  }
  return spare;
}

SampleStore::Place SampleStore::place(std::size_t brick) const noexcept {
  const std::uint32_t slot = slot_of_brick_[brick];
  if (slot == NO_SLOT) return {};
  return {slot / format_.bricksASlab(), slot % format_.bricksASlab()};
}

std::vector<std::uint32_t> SampleStore::bricks() const {
  std::vector<std::uint32_t> list;
  list.reserve(brickCount());
  for (std::size_t brick = 0; brick < slot_of_brick_.size(); ++brick) {
    if (has(brick)) list.push_back(static_cast<std::uint32_t>(brick));
  }
  return list;
}

void SampleStore::add(std::size_t brick, std::optional<std::size_t> beside) {
  slot_of_brick_[brick] = slabs_.take(beside && has(*beside) ? place(*beside).slab : SlotSlabs::kAnySlab);
}

void SampleStore::remove(std::size_t brick) {
  slabs_.release(slot_of_brick_[brick]);
  slot_of_brick_[brick] = NO_SLOT;
}

}  // namespace palpate
