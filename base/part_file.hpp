// SPDX-License-Identifier: Apache-2.0
// base/part_file.hpp: TARGET.PID.palpate-part, the temporary file beside a target that is being written.
//
// The writer holds a lock (flock) on it, which ends with the process, however that ends. So a free lock means that a
// killed process left the file. The process number in the name would not tell, since another process may have it by
// now. Whoever begins to write a target removes the files that killed processes left of it. Nobody else gives files
// such names, so all that is left in a folder may be removed too. Where a file system has no locks nothing is removed.
// Any thread. Cost: reading the names in the target's folder.
#pragma once

#include <filesystem>

#include "base/leftover.hpp"

namespace palpate {

struct PartFile {
  int descriptor = -1;  // open for writing, the caller closes it; -1: there is no file
  std::filesystem::path name;
  int error = 0;      // errno: why there is no file
  Leftover leftover;  // of the file; to be released when it has been renamed or removed
};

// The lock is held until the descriptor is closed. Close it only after the file has been renamed or removed.
[[nodiscard]] PartFile openPartFile(const std::filesystem::path& target);

// Removes what killed processes left in `folder` of any target. An empty `folder` is the working folder.
void sweepPartFiles(const std::filesystem::path& folder);

}  // namespace palpate
