// SPDX-License-Identifier: Apache-2.0
// base/make_folder.hpp: a folder that is there after a power cut, with every level above it that had to be made. Any
// thread. Cost: waiting for the disk, once for each level that is new.
#pragma once

#include <filesystem>
#include <vector>

namespace palpate {

// The folders that get a new entry when `folder` is made: the parent of every level that is not there yet, outermost
// first.
[[nodiscard]] std::vector<std::filesystem::path> foldersThatGrow(const std::filesystem::path& folder);

// 0, or the error's number. What is there already is left alone. Where it fails, some levels may have been made.
[[nodiscard]] int makeFolder(const std::filesystem::path& folder);

}  // namespace palpate
