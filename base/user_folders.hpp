// SPDX-License-Identifier: Apache-2.0
// base/user_folders.hpp: the folders that Palpate has in a person's home (XDG base directories). Any thread.
//
// A variable that is not an absolute path counts as unset, as the specification has it. Empty: neither the variable nor
// the home folder is known. No folder is made.
#pragma once

#include <filesystem>

namespace palpate {

[[nodiscard]] std::filesystem::path settingsFolder();  // $XDG_CONFIG_HOME/palpate, or ~/.config/palpate
[[nodiscard]] std::filesystem::path stateFolder();     // $XDG_STATE_HOME/palpate, or ~/.local/state/palpate
[[nodiscard]] std::filesystem::path cacheFolder();     // $XDG_CACHE_HOME/palpate, or ~/.cache/palpate
// $XDG_RUNTIME_DIR/palpate, which is gone when the user has logged out; the home folder has none.
[[nodiscard]] std::filesystem::path runtimeFolder();
// In it: which devices are calibrated (apps/devices/calibration_stamp.hpp), and nothing else.
[[nodiscard]] std::filesystem::path calibrationsFolder();

}  // namespace palpate
