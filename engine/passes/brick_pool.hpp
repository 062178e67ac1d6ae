// SPDX-License-Identifier: Apache-2.0
// engine/passes/brick_pool.hpp: a volume's densities on the GPU: bricks of 8x8x8 behind a page table, in slabs of up to
// 128 MiB, made and freed as edits go.
//
// Layout: shaders/brick_pool.layout.h. A constant brick has a page and no storage. The page table is kept twice: on the
// GPU for kernels, here for planning. This class hands out slots and keeps its own pages right; what kernels must do
// for it (fill a new slot, write its page) is recorded by whoever took the slot. Pages of bricks that became constant
// are written late (stalePages): until then the GPU still sees the slot, which holds the same value in every voxel and
// is not handed out again. Memory: 8 bytes a brick of the domain here and there. Thread: the Gpu's.
#pragma once

#include <cstddef>
#include <memory>
#include <optional>
#include <vector>

#include "engine/gpu/buffer.hpp"
#include "engine/gpu/transfer.hpp"
#include "engine/passes/slot_slabs.hpp"
#include "engine/volume/volume.hpp"
#include "shaders/brick_pool.layout.h"

namespace palpate {

class BrickPool {
 public:
  // Uploads every brick. Throws Error(kOutOfMemory) where the volume needs more than DENSITY_SLABS slabs, more than the
  // budget or more than the device has. Cost: one pass over the volume.
  BrickPool(gpu::Gpu& gpu, gpu::Transfer& transfer, const Volume& volume,
            std::shared_ptr<GpuBudget> budget = makeGpuBudget());
  // A pool for another field on the same domain and of the same budget; every brick is 0. `name`: for messages.
  BrickPool(gpu::Gpu& gpu, gpu::Transfer& transfer, const BrickPool& like, const std::string& name);

  [[nodiscard]] const layout::PoolDomain& domain() const noexcept { return domain_; }
  [[nodiscard]] const Lattice& lattice() const noexcept { return lattice_; }
  [[nodiscard]] Vec3i size() const noexcept;         // domain [voxel]
  [[nodiscard]] Vec3i brickCounts() const noexcept;  // along each axis
  [[nodiscard]] std::size_t brickCount() const noexcept { return pages_.size(); }
  [[nodiscard]] std::size_t storedBricks() const noexcept { return slabs_->inUse(); }
  [[nodiscard]] std::size_t slabCount() const noexcept { return slabs_->slabCount(); }
  [[nodiscard]] std::size_t bytes() const noexcept { return page_table_->bytes() + slabs_->bytes(); }  // on the GPU
  [[nodiscard]] const std::shared_ptr<GpuBudget>& budget() const noexcept { return budget_; }

  [[nodiscard]] const gpu::Buffer& pages() const noexcept { return *page_table_; }
  // Slab `i` of DENSITY_SLABS: an unused one repeats the first, since every binding must be written.
  [[nodiscard]] const gpu::Buffer& slab(std::size_t i) const noexcept {
    return slabs_->slab(i < slabs_->slabCount() ? i : 0);
  }

  [[nodiscard]] const layout::BrickPage& page(std::size_t brick) const noexcept { return pages_[brick]; }

  void reserve(std::size_t bricks) { slabs_->reserve(bricks); }  // throws as SlotSlabs::reserve does
  [[nodiscard]] std::uint64_t bytesToReserve(std::size_t bricks) const noexcept {
    return slabs_->bytesToReserve(bricks);
  }
  // Gives a constant brick a slot, after reserve(); its content and its page on the GPU are the caller's to write.
  std::uint32_t store(std::size_t brick);
  // Frees the slot of a brick, if it has one, and makes it constant; its page on the GPU is stale from then on.
  void makeConstant(std::size_t brick, float value);
  // Frees the slot of a stored brick, which is constant from then on; its page on the GPU is the caller's to write. The
  // slot may be taken again at once, so nothing recorded before that page may read the brick.
  void empty(std::size_t brick);
  // Changes the value of a constant brick; its page on the GPU is the caller's to write.
  void setConstant(std::size_t brick, float value) noexcept { pages_[brick].constant = value; }
  // The bricks whose pages on the GPU lag behind, since the last call. The caller records their writing before the next
  // kernel takes a slot.
  [[nodiscard]] std::vector<std::uint32_t> takeStalePages();
  [[nodiscard]] std::size_t stalePages() const noexcept { return stale_.size(); }

  // Gives slots to the bricks of `pages` whose slot is not NO_SLOT, in that order, after freeing all; the values of the
  // others hold. The page table is on the GPU when this returns; what the slots hold is the caller's to write. Throws
  // as reserve() does; then every brick is 0.
  void assign(gpu::Transfer& transfer, std::vector<layout::BrickPage> pages);

  // Reads a brick as Volume::readBrick does. Fast where slabs are mapped, else a submission each. Not while submitted
  // work changes the pool.
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
