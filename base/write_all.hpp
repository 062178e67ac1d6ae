// SPDX-License-Identifier: Apache-2.0
// base/write_all.hpp: all bytes to a file, however many calls the system takes for them. Any thread. Cost: those calls.
#pragma once

#include <string_view>

namespace palpate {

// 0, or the error's number; then some of the bytes may have been written.
[[nodiscard]] int writeAll(int descriptor, std::string_view bytes) noexcept;

}  // namespace palpate
