// SPDX-License-Identifier: Apache-2.0
// apps/palpate/version.hpp: version and commit of this program.
#pragma once

namespace palpate {

[[nodiscard]] const char* programVersion() noexcept;  // "0.1.0"
// "0123456789", with "-dirty" added if the tree was changed; or "unknown".
[[nodiscard]] const char* programCommit() noexcept;

}  // namespace palpate
