// SPDX-License-Identifier: Apache-2.0
// base/flush_folder.hpp: flushes a folder's entries to the disk. A new or renamed file survives a power cut only once
// its folder is flushed. Any thread. Cost: waiting for the disk.
#pragma once

#include <filesystem>

namespace palpate {

// 0, or errno. Two cases are no error: a file system that does not flush folders, and a folder that may be written but
// not read.
[[nodiscard]] int flushFolder(const std::filesystem::path& folder);

}  // namespace palpate
