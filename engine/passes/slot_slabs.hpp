// SPDX-License-Identifier: Apache-2.0
// engine/passes/slot_slabs.hpp: slots of one size on the GPU, taken and given back as bricks come and go.
//
// Slots lie in slabs (storage buffers), since Vulkan guarantees only 128 MiB for a binding. The newest slab grows by
// doubling up to its full size; then the next slab begins. Where the budget is short, it grows only by what is asked
// for.
//
// Only reserve() grows a slab. It copies the slab into a larger one, so for a moment there are both; the budget does
// not count the old one, which has at most 128 MiB. Thread: the Gpu's; not while submitted work uses the slabs.
#pragma once

#include <cstddef>
#include <cstdint>
#include <limits>
#include <memory>
#include <string>
#include <vector>

#include "engine/gpu/buffer.hpp"
#include "engine/gpu/commands.hpp"

namespace palpate {

// The GPU memory that the densities and samples of one engine may take together. All its pools and stores share it.
// Thread: the Gpu's.
struct GpuBudget {
  std::uint64_t limit_bytes = std::numeric_limits<std::uint64_t>::max();
  std::uint64_t used_bytes = 0;

  [[nodiscard]] std::uint64_t leftBytes() const noexcept {
    return used_bytes < limit_bytes ? limit_bytes - used_bytes : 0;
  }
};

// `limit_bytes` 0: the device's memory is the only limit.
[[nodiscard]] inline std::shared_ptr<GpuBudget> makeGpuBudget(std::uint64_t limit_bytes = 0) {
  auto budget = std::make_shared<GpuBudget>();
  if (limit_bytes != 0) budget->limit_bytes = limit_bytes;
  return budget;
}

class SlotSlabs {
 public:
  struct Shape {
    std::string name;                // "density", for messages
    std::size_t slot_bytes = 0;      // [byte]
    std::uint32_t slots_a_slab = 0;  // of a slab of full size
    std::size_t max_slabs = 0;       // 0: no limit
  };

  static constexpr std::size_t kAnySlab = static_cast<std::size_t>(-1);

  // Starts with room for `slots` (at least one, so that a kernel has something to bind). Throws as reserve() does.
  SlotSlabs(gpu::Gpu& gpu, Shape shape, std::size_t slots, std::shared_ptr<GpuBudget> budget);
  ~SlotSlabs();
  SlotSlabs(const SlotSlabs&) = delete;
  SlotSlabs& operator=(const SlotSlabs&) = delete;

  // Makes sure that take() can be called `slots` times. Throws Error(kOutOfMemory) where the budget, max_slabs or the
  // device does not allow it. Then every slot in use is unchanged, and room that was gained so far is kept.
  void reserve(std::size_t slots);

  // The least that reserve() would take out of the budget [byte].
  [[nodiscard]] std::uint64_t bytesToReserve(std::size_t slots) const noexcept {
    return slots > free() ? (slots - free()) * shape_.slot_bytes : 0;
  }

  // A free slot; only after reserve(). Prefers a slot in `slab`, if one was given back there.
  [[nodiscard]] std::uint32_t take(std::size_t slab = kAnySlab) noexcept;
  void release(std::uint32_t slot);                 // may be taken again at once
  void releaseAll() noexcept;                       // take() begins with slot 0 again
  [[nodiscard]] std::size_t free() const noexcept;  // slots that can be taken now
  [[nodiscard]] std::size_t inUse() const noexcept { return next_ - free_count_; }

  [[nodiscard]] std::size_t slabCount() const noexcept { return slabs_.size(); }
  [[nodiscard]] const gpu::Buffer& slab(std::size_t i) const noexcept { return slabs_[i]; }
  [[nodiscard]] std::size_t bytes() const noexcept { return capacity_ * shape_.slot_bytes; }

 private:
  void grow(std::size_t wanted_slots);
  void addSlab(std::size_t slots);
  void widenLastSlab(std::size_t slots);
  [[nodiscard]] std::size_t lastSlabSlots() const noexcept;

  gpu::Gpu& gpu_;
  Shape shape_;
  std::shared_ptr<GpuBudget> budget_;
  std::vector<gpu::Buffer> slabs_;
  std::size_t capacity_ = 0;                      // slots of all slabs
  std::size_t next_ = 0;                          // the first slot that was never taken
  std::vector<std::vector<std::uint32_t>> free_;  // slots that were given back, by slab
  std::size_t free_count_ = 0;
  gpu::Commands commands_;
};

}  // namespace palpate
