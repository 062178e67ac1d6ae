// SPDX-License-Identifier: Apache-2.0
// engine/passes/sample_store.hpp: the plane-ready samples (gradient, density) of bricks on the GPU. They lie in slabs
// of up to 128 MiB, with a slot of 8 KiB (4 KiB as halves) for each brick that has samples. Slots are taken and freed
// as the set of active bricks changes (active_bricks.hpp). Memory on the host: 4 bytes for each brick of the domain.
// Thread: the Gpu's.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <vector>

#include "engine/gpu/buffer.hpp"
#include "engine/gradient/sample_format.hpp"
#include "engine/passes/slot_slabs.hpp"
#include "shaders/brick_pool.layout.h"

namespace palpate {

class SampleStore {
 public:
  // Room for the samples of `bricks` (linear page indices), in slots 0, 1, ... in that order. Where they fill more than
  // one slab, each slab keeps a sixteenth of its slots free for later bricks, if the budget allows. A kernel sees one
  // slab at a time, so a new brick should find room in the slab of its neighbours. Throws Error(kOutOfMemory) if the
  // budget or the device has too little memory.
  SampleStore(gpu::Gpu& gpu, std::size_t brick_count, const std::vector<std::uint32_t>& bricks,
              std::shared_ptr<GpuBudget> budget = makeGpuBudget(), const SampleFormat& format = {});

  [[nodiscard]] const SampleFormat& format() const noexcept { return format_; }

  struct Place {
    std::uint32_t slab = 0;
    std::uint32_t slot = NO_SLOT;  // within the slab, or NO_SLOT where the brick has no samples
  };
  [[nodiscard]] Place place(std::size_t brick) const noexcept;
  [[nodiscard]] bool has(std::size_t brick) const noexcept { return slot_of_brick_[brick] != NO_SLOT; }
  [[nodiscard]] std::size_t brickCount() const noexcept { return slabs_.inUse(); }  // that have samples
  [[nodiscard]] std::vector<std::uint32_t> bricks() const;  // these bricks, ascending; cost: a look at every brick

  void reserve(std::size_t bricks) { slabs_.reserve(bricks); }  // throws as SlotSlabs::reserve does
  [[nodiscard]] std::uint64_t bytesToReserve(std::size_t bricks) const noexcept {
    return slabs_.bytesToReserve(bricks);
  }
  // Gives a slot to a brick without samples; only after reserve(). In the slab of `beside`, a brick near it, if that
  // slab has room.
  void add(std::size_t brick, std::optional<std::size_t> beside = {});
  void remove(std::size_t brick);  // frees the slot of a brick with samples

  [[nodiscard]] std::size_t slabCount() const noexcept { return slabs_.slabCount(); }
  [[nodiscard]] const gpu::Buffer& slab(std::size_t i) const noexcept { return slabs_.slab(i); }
  [[nodiscard]] std::size_t bytes() const noexcept { return slabs_.bytes(); }

 private:
  [[nodiscard]] std::size_t spareOf(std::size_t bricks);

  SampleFormat format_;
  SlotSlabs slabs_;
  std::vector<std::uint32_t> slot_of_brick_;  // NO_SLOT: no samples
};

}  // namespace palpate
