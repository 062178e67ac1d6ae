// SPDX-License-Identifier: Apache-2.0
#include "engine/passes/pool_kernel.hpp"

#include <algorithm>

#include "shaders/kernels.hpp"

namespace palpate {

PoolKernel::PoolKernel(gpu::Gpu& gpu, std::string name, const BrickPool& pool, std::uint32_t bindings,
                       std::size_t push_bytes, std::vector<std::uint32_t> more, const BrickPool* second)
    : gpu_(gpu),
      name_(std::move(name)),
      pool_(pool),
      second_(second),
      bindings_(bindings),
      push_bytes_(static_cast<std::uint32_t>(push_bytes)),
      constants_(std::move(more)) {
  constants_.insert(constants_.begin(), 0);
  if (second != nullptr) constants_.push_back(0);
  (void)get();  // so that a driver refuses the shader now, not later
}

const gpu::Kernel& PoolKernel::get() {
  const auto slabsOf = [](const BrickPool& pool) { return static_cast<std::uint32_t>(pool.slabCount()); };
  std::vector<std::uint32_t> constants = constants_;
  constants.front() = slabsOf(pool_);
  if (second_ != nullptr) constants.back() = slabsOf(*second_);
  if (constants_ != constants) {
    kernel_ = gpu::Kernel(gpu_, gpu::KernelSpec{.name = name_,  // if it throws, the old kernel stays
                                                .spirv = poolKernelSpirv(name_, constants.front()),
                                                .bindings = bindings_,
                                                .push_bytes = push_bytes_,
                                                .specialisation = constants});
    constants_ = std::move(constants);
  }
  return *kernel_;
}

std::vector<const gpu::Buffer*> poolBindings(const BrickPool& pool, std::initializer_list<const gpu::Buffer*> own) {
  std::vector<const gpu::Buffer*> buffers = {&pool.pages()};
  for (std::size_t i = 0; i < DENSITY_SLABS; ++i) buffers.push_back(&pool.slab(i));
  buffers.insert(buffers.end(), own);
  return buffers;
}

}  // namespace palpate
