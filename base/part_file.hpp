// SPDX-License-Identifier: Apache-2.0
// base/part_file.hpp: the temporary file beside a target that is being written, TARGET.PID.part.
//
// Its writer holds a lock on it (flock), which ends with the process, however that ends. So what a killed process left
// is told from what is being written by trying the lock, and not by the number of a process, which another one may
// have by now: whoever begins to write a target removes what others left of it. Where a file system has no locks
// nothing is removed. Any thread. Cost: reading the names in the target's folder.
#pragma once

#include <filesystem>
#include <functional>
#include <string_view>

namespace palpate {

struct PartFile {
  int descriptor = -1;  // for writing, the caller's to close; -1: there is none
  std::filesystem::path name;
  int error = 0;  // why there is none
};

// Its lock is held until the descriptor is closed: not before the file has been renamed or removed.
[[nodiscard]] PartFile openPartFile(const std::filesystem::path& target);

// Removes what killed processes left in a folder of targets of these names ("a.vdb"). "": the working folder.
void sweepPartFiles(const std::filesystem::path& folder, const std::function<bool(std::string_view target)>& is_meant);

}  // namespace palpate
