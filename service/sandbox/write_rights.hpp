// SPDX-License-Identifier: Apache-2.0
// service/sandbox/write_rights.hpp: takes from this process the right to write, make and remove files (Landlock, Linux
// 5.13). Set-up code.
#pragma once

#include <filesystem>
#include <span>

namespace palpate {

// `written`: below these folders files that are there may be written. `kept`: below these files may also be made and
// removed. False: this kernel has no Landlock, or refuses; then nothing has changed. Needs no_new_privs.
[[nodiscard]] bool giveUpWriting(std::span<const std::filesystem::path> written,
                                 std::span<const std::filesystem::path> kept) noexcept;

}  // namespace palpate
