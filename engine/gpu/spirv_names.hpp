// SPDX-License-Identifier: Apache-2.0
// engine/gpu/spirv_names.hpp: the names that a shader's source gives its specialisation constants. Any thread; reads
// the shader once.
#pragma once

#include <cstdint>
#include <map>
#include <span>
#include <string>

namespace palpate::gpu {

// By constant_id. A constant is not there if the compiler found no use for it, or if the names were stripped. Words
// that are no SPIR-V have none.
[[nodiscard]] std::map<std::uint32_t, std::string> constantNames(std::span<const std::uint32_t> spirv);

}  // namespace palpate::gpu
