// SPDX-License-Identifier: Apache-2.0
// shaders/kernels.hpp: the compiled kernels, embedded in the program. Any thread; no cost.
#pragma once

#include <cstdint>
#include <span>
#include <string_view>

namespace palpate {

// SPIR-V of the kernel `name` ("gradient" for gradient.comp). Throws Error(kDevice) if the program has no such kernel.
[[nodiscard]] std::span<const std::uint32_t> kernelSpirv(std::string_view name);

}  // namespace palpate
