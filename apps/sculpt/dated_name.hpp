// SPDX-License-Identifier: Apache-2.0
// apps/sculpt/dated_name.hpp: names for files that nobody named: pictures of the window, recordings. Any thread.
#pragma once

#include <ctime>
#include <filesystem>
#include <string>

namespace palpate {

// "FOLDER/palpate-20261123-141503.png", by this moment's local time; with "-2", "-3", ... where there is such a file.
[[nodiscard]] std::filesystem::path datedName(const std::filesystem::path& folder, const std::string& first,
                                              const std::string& suffix, std::time_t now = std::time(nullptr));

}  // namespace palpate
