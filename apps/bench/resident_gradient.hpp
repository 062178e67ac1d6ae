// SPDX-License-Identifier: Apache-2.0
// apps/bench/resident_gradient.hpp: a gradient operator that is ready to run on some bricks of a volume: its buffers
// are allocated and its kernels compiled. Thread: the Gpu's.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "apps/bench/resident_chain.hpp"
#include "apps/rivals/rivals.hpp"
#include "engine/gpu/transfer.hpp"
#include "engine/passes/gradient_pass.hpp"
#include "servo/window/sample_window.hpp"

namespace palpate {

class ResidentGradient {
 public:
  // `gpu`, `transfer` and `pool` must outlive it. Throws Error as GradientPass and SampleStore do.
  ResidentGradient(gpu::Gpu& gpu, gpu::Transfer& transfer, const BrickPool& pool,
                   const GradientOperator& gradient_operator, const std::vector<std::uint32_t>& bricks,
                   const SampleFormat& format);

  RunCost run();

  // Bytes of densities read and samples written. An operator that smooths also reads the original densities, which its
  // samples hold.
  [[nodiscard]] double movedBytes() const;

  // What the last run stored for these voxels, which lie in its bricks. Cost: a copy of all samples.
  [[nodiscard]] std::vector<Sample> at(std::span<const Vec3i> voxels) const;

 private:
  gpu::Transfer& transfer_;
  const BrickPool& pool_;
  std::vector<FilterStep> steps_;
  SampleStore store_;
  std::optional<ResidentChain> smoothing_;
  std::optional<GradientPass> pass_;
  std::vector<TaskRange> ranges_;
  std::optional<gpu::Buffer> tasks_;
  std::optional<gpu::Commands> commands_;
};

// Samples as halves for this volume, at the isovalue that it declares.
[[nodiscard]] SampleFormat halvesFor(const Volume& volume);

}  // namespace palpate
