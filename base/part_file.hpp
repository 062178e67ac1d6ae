// SPDX-License-Identifier: Apache-2.0
// base/part_file.hpp: TARGET.PID.palpate-part, the temporary file beside a target that is being written.
//
// The writer holds a lock (flock) on it. The lock ends with the process, however the process ends. So a temporary file
// without a lock was left by a killed process. The process number in the name cannot tell that, since another process
// may have it by now.
// Whoever begins to write a target removes such files of that target. No other program gives files such names, so those
// of all targets in a folder may be removed too. On a file system without locks nothing is removed.
// A target whose name leaves no room for this is shortened to its first bytes, '~' and a checksum of the whole.
// Any thread. Cost: reading the names in the target's folder.
#pragma once

#include <cstdint>
#include <filesystem>

#include "base/leftover.hpp"

namespace palpate {

struct PartFile {
  int descriptor = -1;  // open for writing, the caller closes it; -1: there is no file
  std::filesystem::path name;
  int error = 0;      // errno: why there is no file
  Leftover leftover;  // of the file; to be released when it has been renamed or removed
};

// Who may read a new file: whoever the process's umask lets, or its owner alone (0600; folders 0700), as befits what
// holds a patient's densities.
enum class Rights : std::uint8_t { kUsual, kPrivate };

// The lock is held until the descriptor is closed. Close it only after the file has been renamed or removed.
[[nodiscard]] PartFile openPartFile(const std::filesystem::path& target, Rights rights = Rights::kUsual);

// Removes what killed processes left in `folder`, whatever its target. An empty `folder` is the working folder.
void sweepPartFiles(const std::filesystem::path& folder);

}  // namespace palpate
