// SPDX-License-Identifier: Apache-2.0
// base/flush_folder.hpp: brings a folder's entries to the disk: a file that was made or renamed is there after a power
// cut only once its folder is. Any thread. Cost: waiting for the disk.
#pragma once

#include <filesystem>

namespace palpate {

// 0, or the error's number. Some file systems do not flush folders: they keep their own promises, which is no error;
// nor is a folder that may be written but not read.
[[nodiscard]] int flushFolder(const std::filesystem::path& folder);

}  // namespace palpate
