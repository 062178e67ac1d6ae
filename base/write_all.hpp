// SPDX-License-Identifier: Apache-2.0
// base/write_all.hpp: writes all bytes to a file, in as many system calls as it takes. Any thread. Cost: those calls.
#pragma once

#include <string_view>

namespace palpate {

// 0, or errno. After an error some of the bytes may have been written.
[[nodiscard]] int writeAll(int descriptor, std::string_view bytes) noexcept;

}  // namespace palpate
