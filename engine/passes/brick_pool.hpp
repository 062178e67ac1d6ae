// SPDX-License-Identifier: Apache-2.0
// engine/passes/brick_pool.hpp: a volume's densities on the GPU: bricks of 8x8x8 behind a page table, in slabs of up to
// 128 MiB. Slots for bricks are taken and freed as edits go.
//
// Layout: shaders/brick_pool.layout.h. A constant brick has a page and no storage. The page table exists twice: on the
// GPU for kernels, on the host for planning. This class hands out slots and keeps the host's pages current. Whoever
// takes a slot records the GPU's work for it: filling the slot and writing its page.
//
// The page of a brick that became constant is written late (takeStalePages). Until then the GPU still reads the slot,
// which holds the same value in every voxel and is not handed out again. Memory: 8 bytes for each brick of the domain,
// on the GPU and on the host. Thread: the Gpu's.
#pragma once

#include <cstddef>
#include <memory>
#include <optional>
#include <vector>

#include "engine/bricks/brick_grid.hpp"
#include "engine/field/volume.hpp"
#include "engine/gpu/buffer.hpp"
#include "engine/gpu/transfer.hpp"
#include "engine/passes/slot_slabs.hpp"
#include "shaders/brick_pool.layout.h"

namespace palpate {

inline constexpr std::size_t kBrickBytes = kBrickVoxels * sizeof(float);  // densities of a brick [byte]

class BrickPool {
 public:
  // Uploads every brick. Throws Error(kOutOfMemory) where the volume needs more than DENSITY_SLABS slabs, than the
  // budget allows or than the device has. Cost: one pass over the volume.
  BrickPool(gpu::Gpu& gpu, gpu::Transfer& transfer, const Volume& volume,
            std::shared_ptr<GpuBudget> budget = makeGpuBudget());
  // A pool for another field on the domain of `like`, with the same budget; every brick is 0. `name`: for messages.
  BrickPool(gpu::Gpu& gpu, gpu::Transfer& transfer, const BrickPool& like, const std::string& name);

  [[nodiscard]] const layout::PoolDomain& domain() const noexcept { return domain_; }
  [[nodiscard]] const Lattice& lattice() const noexcept { return lattice_; }
  [[nodiscard]] Vec3i size() const noexcept;  // domain [voxel]
  [[nodiscard]] BrickGrid grid() const noexcept { return {size(), lattice_.spacing_m}; }
  [[nodiscard]] std::size_t brickCount() const noexcept { return pages_.size(); }
  [[nodiscard]] std::size_t storedBricks() const noexcept { return slabs_->inUse(); }
  [[nodiscard]] std::size_t slabCount() const noexcept { return slabs_->slabCount(); }
  [[nodiscard]] std::size_t bytes() const noexcept { return page_table_->bytes() + slabs_->bytes(); }  // on the GPU
  [[nodiscard]] const std::shared_ptr<GpuBudget>& budget() const noexcept { return budget_; }

  [[nodiscard]] const gpu::Buffer& pages() const noexcept { return *page_table_; }
  // Slab `i` of DENSITY_SLABS. An unused one is the first again, since every binding must be written.
  [[nodiscard]] const gpu::Buffer& slab(std::size_t i) const noexcept {
    return slabs_->slab(i < slabs_->slabCount() ? i : 0);
  }

  [[nodiscard]] const layout::BrickPage& page(std::size_t brick) const noexcept { return pages_[brick]; }
  [[nodiscard]] bool isStored(std::size_t brick) const noexcept { return pages_[brick].slot != NO_SLOT; }
  // The one density that a brick holds; empty if it is stored.
  [[nodiscard]] std::optional<float> constantOf(std::size_t brick) const noexcept {
    return isStored(brick) ? std::nullopt : std::optional(pages_[brick].constant);
  }

  void reserve(std::size_t bricks) { slabs_->reserve(bricks); }  // throws as SlotSlabs::reserve does
  [[nodiscard]] std::uint64_t bytesToReserve(std::size_t bricks) const noexcept {
    return slabs_->bytesToReserve(bricks);
  }
  // Gives a constant brick a slot; only after reserve(). The caller writes the slot's content and the GPU's page.
  std::uint32_t store(std::size_t brick);
  // Makes a brick constant and frees its slot, if it has one. Its page on the GPU is stale from then on.
  void makeConstant(std::size_t brick, float value);
  // Makes a stored brick constant and frees its slot. The caller writes the GPU's page. The slot may be taken again at
  // once, so no work recorded before that write may read the brick.
  void empty(std::size_t brick);
  // Changes the value of a constant brick. The caller writes the GPU's page.
  void setConstant(std::size_t brick, float value) noexcept { pages_[brick].constant = value; }
  // The bricks whose pages on the GPU have become stale since the last call. The caller records the writing of these
  // pages before the next kernel fills a slot.
  [[nodiscard]] std::vector<std::uint32_t> takeStalePages();
  [[nodiscard]] std::size_t stalePages() const noexcept { return stale_.size(); }

  // Replaces all pages: frees every slot, then gives new slots, in order, to the bricks whose slot in `pages` is not
  // NO_SLOT. The others are constant, with the value in `pages`. The page table is on the GPU when this returns; the
  // caller writes the slots' content. Throws as reserve() does; then every brick is 0.
  void assign(gpu::Transfer& transfer, std::vector<layout::BrickPage> pages);

  // Reads a brick as Volume::readBrick does. Cost: a copy where slabs are mapped, else a submission for each brick. Not
  // while submitted work changes the pool.
  bool readBrick(gpu::Transfer& transfer, std::size_t brick, float* values) const;

  // Where a slot's densities lie.
  struct Place {
    std::size_t slab = 0;
    std::size_t offset_bytes = 0;
  };
  [[nodiscard]] static Place place(std::uint32_t slot) noexcept;

 private:
  void upload(gpu::Transfer& transfer, const std::vector<float>& values, std::uint32_t first_slot);

  layout::PoolDomain domain_{};
  Lattice lattice_;
  std::shared_ptr<GpuBudget> budget_;
  std::unique_ptr<SlotSlabs> slabs_;
  std::vector<layout::BrickPage> pages_;
  std::vector<std::uint32_t> stale_;
  std::optional<gpu::Buffer> page_table_;
};

}  // namespace palpate
