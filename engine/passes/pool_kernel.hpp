// SPDX-License-Identifier: Apache-2.0
// engine/passes/pool_kernel.hpp: a kernel that reads the brick pool: the pool's bindings first, its own after.
//
// It is specialised for as many slabs as the pool has; when that gets another one the kernel is built once more, which
// costs the driver's compiler some 50 ms. Thread: the Gpu's.
#pragma once

#include <cstdint>
#include <initializer_list>
#include <optional>
#include <string>
#include <vector>

#include "engine/gpu/kernel.hpp"
#include "engine/passes/brick_pool.hpp"

namespace palpate {

class PoolKernel {
 public:
  // `name`: of the shader, as in shaders/NAME.comp. `more`: specialisation constants 1, 2, ... `second`: another pool
  // that it reads; how many slabs it has, 1 to DENSITY_SLABS, is the last constant.
  PoolKernel(gpu::Gpu& gpu, std::string name, const BrickPool& pool, std::uint32_t bindings, std::size_t push_bytes,
             std::vector<std::uint32_t> more = {}, const BrickPool* second = nullptr);

  // The kernel for the pool as it is now. Not while submitted work still uses the last one.
  [[nodiscard]] const gpu::Kernel& get();

 private:
  gpu::Gpu& gpu_;
  std::string name_;
  const BrickPool& pool_;
  const BrickPool* second_;
  std::uint32_t bindings_;
  std::uint32_t push_bytes_;
  std::vector<std::uint32_t> constants_;  // the first one: slabs
  std::optional<gpu::Kernel> kernel_;
};

// Buffers in binding order: pages, slabs, then `own`.
[[nodiscard]] std::vector<const gpu::Buffer*> poolBindings(const BrickPool& pool,
                                                           std::initializer_list<const gpu::Buffer*> own);

}  // namespace palpate
