// SPDX-License-Identifier: Apache-2.0
#include "engine/passes/sample_store.hpp"

#include <algorithm>

#include <fmt/format.h>

#include "engine/volume/volume.hpp"
#include "servo/window/sample_window.hpp"

namespace palpate {

SampleStore::SampleStore(gpu::Gpu& gpu, std::size_t brick_count, const std::vector<std::uint32_t>& bricks)
    : bricks_(bricks), slot_of_brick_(brick_count, NO_SLOT) {
  for (std::size_t slot = 0; slot < bricks.size(); ++slot)
    slot_of_brick_[bricks[slot]] = static_cast<std::uint32_t>(slot);
  // At least one slab, so that a kernel has something to bind.
  for (std::size_t first = 0; first == 0 || first < bricks.size(); first += BRICKS_PER_SAMPLE_SLAB) {
    const std::size_t count = std::clamp<std::size_t>(bricks.size() - first, 1, BRICKS_PER_SAMPLE_SLAB);
    slabs_.emplace_back(gpu, fmt::format("sample slab {}", slabs_.size()), count * kBrickVoxels * sizeof(Sample),
                        gpu::MemoryKind::kDevice);
  }
}

SampleStore::Place SampleStore::place(std::size_t brick) const noexcept {
  const std::uint32_t slot = slot_of_brick_[brick];
  if (slot == NO_SLOT) return {};
  return {slot / BRICKS_PER_SAMPLE_SLAB, slot % BRICKS_PER_SAMPLE_SLAB};
}

std::size_t SampleStore::bytes() const noexcept {
  std::size_t total = 0;
  for (const gpu::Buffer& slab : slabs_) total += slab.bytes();
  return total;
}

}  // namespace palpate
