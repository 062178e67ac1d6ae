// SPDX-License-Identifier: Apache-2.0
// base/durable_io.hpp: writes that survive a power cut: all bytes of a file, the entries of a folder, new folders.
//
// Each function returns 0 or errno. Any thread.
#pragma once

#include <filesystem>
#include <string_view>
#include <vector>

#include "base/part_file.hpp"

namespace palpate {

// Writes all bytes, in as many system calls as it takes. After an error some of the bytes may have been written.
[[nodiscard]] int writeAll(int descriptor, std::string_view bytes) noexcept;

// Flushes the entries of a folder to the disk. A new or renamed file survives a power cut only once its folder is
// flushed. Two cases are no error: a file system that does not flush folders, and a folder that may be written but not
// read. Cost: waiting for the disk.
[[nodiscard]] int flushFolder(const std::filesystem::path& folder);

// Makes a folder with all missing levels above it, and flushes the parent of each new level. Existing folders are left
// alone, their rights too. After an error some levels may have been made. Cost: waiting for the disk, once for each new
// level.
[[nodiscard]] int makeFolder(const std::filesystem::path& folder, Rights rights = Rights::kUsual);

// The folders that makeFolder() would flush: the parent of each missing level, outermost first.
[[nodiscard]] std::vector<std::filesystem::path> parentsOfNewLevels(const std::filesystem::path& folder);

}  // namespace palpate
