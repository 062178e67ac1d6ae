// SPDX-License-Identifier: Apache-2.0
// engine/passes/slot_slabs.hpp: slots of one size on the GPU, taken and given back as bricks come and go.
//
// Slots lie in slabs, since a storage buffer binding is guaranteed 128 MiB only. The newest slab grows by doubling, up
// to a whole one; then the next begins. Where the budget is short it grows by what is asked for. Growing copies what
// the newest slab holds and happens in reserve() alone; the old one is there beside the new until then, which the
// budget does not count: at most 128 MiB for a moment. Thread: the Gpu's; not while submitted work uses the slabs.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "engine/gpu/buffer.hpp"
#include "engine/gpu/commands.hpp"
#include "engine/passes/gpu_budget.hpp"

namespace palpate {

class SlotSlabs {
 public:
  struct Shape {
    std::string name;                // "density", for messages
    std::size_t slot_bytes = 0;      // [byte]
    std::uint32_t slots_a_slab = 0;  // of a whole slab
    std::size_t max_slabs = 0;       // that may be; 0: no limit
  };

  static constexpr std::size_t kAnySlab = static_cast<std::size_t>(-1);

  // Starts with room for `slots` (at least one, so that a kernel has something to bind). Throws as reserve() does.
  SlotSlabs(gpu::Gpu& gpu, Shape shape, std::size_t slots, std::shared_ptr<GpuBudget> budget);
  ~SlotSlabs();
  SlotSlabs(const SlotSlabs&) = delete;
  SlotSlabs& operator=(const SlotSlabs&) = delete;

  // Makes sure that take() can be called `slots` times. Throws Error(kOutOfMemory) where the budget, the slabs or the
  // device do not allow it; every slot in use then is as it was, and what could be had stays for later.
  void reserve(std::size_t slots);

  // What reserve() would take out of the budget at least [byte].
  [[nodiscard]] std::uint64_t bytesToReserve(std::size_t slots) const noexcept {
    return slots > free() ? (slots - free()) * shape_.slot_bytes : 0;
  }

  // A free slot; only after reserve(). In `slab` if there is one that was given back there.
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
  std::size_t next_ = 0;                          // slots below this one have been taken at some time
  std::vector<std::vector<std::uint32_t>> free_;  // of those, given back, by slab
  std::size_t free_count_ = 0;
  gpu::Commands commands_;
};

}  // namespace palpate
