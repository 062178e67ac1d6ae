// SPDX-License-Identifier: Apache-2.0
// service/sandbox/write_rights.hpp: takes from this process the right to write, make and remove files (Landlock, Linux
// 5.13). Set-up code.
#pragma once

#include <span>

namespace palpate {

// But below these folders, whose files may be written. False: this kernel has no Landlock, or refuses; then nothing has
// changed. Needs no_new_privs.
[[nodiscard]] bool giveUpWriting(std::span<const char* const> but_below) noexcept;

}  // namespace palpate
