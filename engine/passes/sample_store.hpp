// SPDX-License-Identifier: Apache-2.0
// engine/passes/sample_store.hpp: where the plane-ready samples (gradient, density) of bricks live on the GPU: slabs of
// 128 MiB, 8 KiB a brick, and a slot for each brick that has them. Thread: the Gpu's.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "engine/gpu/buffer.hpp"
#include "shaders/brick_pool.layout.h"

namespace palpate {

class SampleStore {
 public:
  // Room for the samples of `bricks` (linear page indices). Throws Error(kOutOfMemory) if the device has not enough.
  SampleStore(gpu::Gpu& gpu, std::size_t brick_count, const std::vector<std::uint32_t>& bricks);

  struct Place {
    std::uint32_t slab = 0;
    std::uint32_t slot = NO_SLOT;  // within the slab, or NO_SLOT where the brick has no samples
  };
  [[nodiscard]] Place place(std::size_t brick) const noexcept;
  [[nodiscard]] std::size_t slabCount() const noexcept { return slabs_.size(); }
  [[nodiscard]] const gpu::Buffer& slab(std::size_t i) const noexcept { return slabs_[i]; }
  [[nodiscard]] const std::vector<std::uint32_t>& bricks() const noexcept { return bricks_; }
  [[nodiscard]] std::size_t bytes() const noexcept;

 private:
  std::vector<std::uint32_t> bricks_;         // by slot
  std::vector<std::uint32_t> slot_of_brick_;  // NO_SLOT where there is none
  std::vector<gpu::Buffer> slabs_;
};

}  // namespace palpate
