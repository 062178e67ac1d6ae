// SPDX-License-Identifier: Apache-2.0
// apps/palpate/version.hpp: version and commit of this program.
#pragma once

namespace palpate {

[[nodiscard]] const char* programVersion() noexcept;  // "0.1.0"
[[nodiscard]] const char*
programCommit() noexcept;  // "0123456789", "-dirty" behind it for a changed tree, or "unknown"

}  // namespace palpate
