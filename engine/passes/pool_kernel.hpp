// SPDX-License-Identifier: Apache-2.0
// engine/passes/pool_kernel.hpp: a kernel that reads the brick pool: the pool's bindings first, its own after.
#pragma once

#include <cstdint>
#include <initializer_list>
#include <string>
#include <vector>

#include "engine/gpu/kernel.hpp"
#include "engine/passes/brick_pool.hpp"

namespace palpate {

// `name`: of the shader, as in shaders/NAME.comp. Specialised for the number of slabs that this pool uses.
[[nodiscard]] gpu::Kernel makePoolKernel(gpu::Gpu& gpu, const std::string& name, const BrickPool& pool,
                                         std::uint32_t bindings, std::size_t push_bytes);

// Buffers in binding order: pages, slabs, then `own`.
[[nodiscard]] std::vector<const gpu::Buffer*> poolBindings(const BrickPool& pool,
                                                           std::initializer_list<const gpu::Buffer*> own);

}  // namespace palpate
