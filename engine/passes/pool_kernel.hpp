// SPDX-License-Identifier: Apache-2.0
// engine/passes/pool_kernel.hpp: a kernel that reads a brick pool. The pool's bindings come first, the kernel's own
// after.
//
// The kernel is specialised for the number of slabs that the pool has. When the pool gets another slab, the kernel is
// built again, which costs some 50 ms of the driver's compiler. Thread: the Gpu's.
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
  // `name`: of the shader shaders/NAME.comp. `more`: specialisation constants 1, 2, ... `second`: another pool that it
  // reads; the last constant is then the number of that pool's slabs, 1 to DENSITY_SLABS.
  PoolKernel(gpu::Gpu& gpu, std::string name, const BrickPool& pool, std::uint32_t bindings, std::size_t push_bytes,
             std::vector<std::uint32_t> more = {}, const BrickPool* second = nullptr);

  // The kernel for the pool's present slabs, built if need be. Not while submitted work uses the former kernel.
  [[nodiscard]] const gpu::Kernel& get();

 private:
  gpu::Gpu& gpu_;
  std::string name_;
  const BrickPool& pool_;
  const BrickPool* second_;
  std::uint32_t bindings_;
  std::uint32_t push_bytes_;
  std::vector<std::uint32_t> constants_;  // the first one: number of slabs
  std::optional<gpu::Kernel> kernel_;
};

// Buffers in binding order: pages, slabs, then `own`.
[[nodiscard]] std::vector<const gpu::Buffer*> poolBindings(const BrickPool& pool,
                                                           std::initializer_list<const gpu::Buffer*> own);

}  // namespace palpate
