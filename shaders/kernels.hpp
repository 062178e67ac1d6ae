// SPDX-License-Identifier: Apache-2.0
// shaders/kernels.hpp: the compiled kernels, embedded in the program. Any thread; no cost.
#pragma once

#include <cstdint>
#include <span>
#include <string_view>

namespace palpate {

// SPIR-V of the kernel `name` ("gradient" for gradient.comp). Throws Error(kDevice) if the program has no such kernel.
[[nodiscard]] std::span<const std::uint32_t> kernelSpirv(std::string_view name);

// The same for a kernel whose first specialisation constant is the number of slabs of the brick pool that it reads. For
// one slab there is a shorter one, which does the same.
[[nodiscard]] std::span<const std::uint32_t> poolKernelSpirv(std::string_view name, std::uint32_t slabs);

}  // namespace palpate
