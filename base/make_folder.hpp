// SPDX-License-Identifier: Apache-2.0
// base/make_folder.hpp: makes a folder, with all missing levels above it, so that it survives a power cut. Any thread.
// Cost: waiting for the disk, once for each level that is new.
#pragma once

#include <filesystem>
#include <vector>

namespace palpate {

// The folders that get a new entry when `folder` is made: the parent of each missing level, outermost first.
[[nodiscard]] std::vector<std::filesystem::path> foldersThatGrow(const std::filesystem::path& folder);

// 0, or errno. Folders that are there already are left alone. After an error some levels may have been made.
[[nodiscard]] int makeFolder(const std::filesystem::path& folder);

}  // namespace palpate
