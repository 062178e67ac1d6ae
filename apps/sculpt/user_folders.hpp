// SPDX-License-Identifier: Apache-2.0
// apps/sculpt/user_folders.hpp: where a person's settings and journals are kept (XDG base directories). Any thread.
#pragma once

#include <filesystem>

namespace palpate {

// $XDG_CONFIG_HOME/palpate, or ~/.config/palpate; empty where neither is known. A variable that is not an absolute path
// counts as unset, as the specification has it.
[[nodiscard]] std::filesystem::path settingsFolder();
// $XDG_STATE_HOME/palpate/journals, or ~/.local/state/palpate/journals; empty likewise.
[[nodiscard]] std::filesystem::path journalsFolder();

}  // namespace palpate
