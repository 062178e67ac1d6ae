// SPDX-License-Identifier: Apache-2.0
// engine/passes/brick_pool.hpp: a volume's densities on the GPU: bricks of 8x8x8 behind a page table, in slabs of 128
// MiB.
//
// Layout: shaders/brick_pool.layout.h. A constant brick has a page and no storage. Thread: the Gpu's.
#pragma once

#include <cstddef>
#include <vector>

#include "engine/gpu/buffer.hpp"
#include "engine/gpu/transfer.hpp"
#include "engine/volume/volume.hpp"
#include "shaders/brick_pool.layout.h"

namespace palpate {

class BrickPool {
 public:
  // Uploads every brick. Throws Error(kOutOfMemory) where the volume needs more than DENSITY_SLABS slabs or more than
  // the device has. Cost: one pass over the volume.
  BrickPool(gpu::Gpu& gpu, gpu::Transfer& transfer, const Volume& volume);

  [[nodiscard]] const layout::PoolDomain& domain() const noexcept { return domain_; }
  [[nodiscard]] const Lattice& lattice() const noexcept { return lattice_; }
  [[nodiscard]] Vec3i size() const noexcept;         // domain [voxel]
  [[nodiscard]] Vec3i brickCounts() const noexcept;  // along each axis
  [[nodiscard]] std::size_t brickCount() const noexcept;
  [[nodiscard]] std::size_t storedBricks() const noexcept { return stored_bricks_; }
  [[nodiscard]] std::size_t slabCount() const noexcept { return slabs_.size(); }
  [[nodiscard]] std::size_t bytes() const noexcept;  // on the GPU

  [[nodiscard]] const gpu::Buffer& pages() const noexcept { return pages_.front(); }
  // Slab `i` of DENSITY_SLABS: an unused one repeats the first, since every binding must be written.
  [[nodiscard]] const gpu::Buffer& slab(std::size_t i) const noexcept { return slabs_[i < slabs_.size() ? i : 0]; }

 private:
  void addSlab(gpu::Gpu& gpu, gpu::Transfer& transfer, const std::vector<float>& values);

  layout::PoolDomain domain_{};
  Lattice lattice_;
  std::size_t stored_bricks_ = 0;
  std::vector<gpu::Buffer> pages_;  // exactly one; a vector because it is made after the slabs
  std::vector<gpu::Buffer> slabs_;
};

}  // namespace palpate
