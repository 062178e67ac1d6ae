// SPDX-License-Identifier: Apache-2.0
#include "engine/passes/pool_kernel.hpp"

#include "shaders/kernels.hpp"

namespace palpate {

gpu::Kernel makePoolKernel(gpu::Gpu& gpu, const std::string& name, const BrickPool& pool, std::uint32_t bindings,
                           std::size_t push_bytes) {
  return {gpu, gpu::KernelSpec{.name = name,
                               .spirv = kernelSpirv(name),
                               .bindings = bindings,
                               .push_bytes = static_cast<std::uint32_t>(push_bytes),
                               .specialisation = {static_cast<std::uint32_t>(pool.slabCount())}}};
}

std::vector<const gpu::Buffer*> poolBindings(const BrickPool& pool, std::initializer_list<const gpu::Buffer*> own) {
  std::vector<const gpu::Buffer*> buffers = {&pool.pages()};
  for (std::size_t i = 0; i < DENSITY_SLABS; ++i) buffers.push_back(&pool.slab(i));
  buffers.insert(buffers.end(), own);
  return buffers;
}

}  // namespace palpate
