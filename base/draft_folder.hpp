// SPDX-License-Identifier: Apache-2.0
// base/draft_folder.hpp: a folder for unfinished files, PARENT/PREFIXxxxxxx, which its owner removes.
//
// The owner holds a lock on the folder, as on temporary files (base/part_file.hpp). The lock ends with the process,
// however the process ends. So an unlocked folder was left by a killed process. Making a folder removes all such
// folders that have the same prefix and parent. On a file system without locks nothing is removed.
// Any thread. Cost: reading the names in the parent.
#pragma once

#include <filesystem>
#include <string>

#include "base/leftover.hpp"

namespace palpate {

class DraftFolder {
 public:
  // Throws std::system_error, with the system's message alone, if no folder can be made.
  DraftFolder(const std::filesystem::path& parent, const std::string& prefix);
  ~DraftFolder();  // removes it, with all that is in it
  DraftFolder(const DraftFolder&) = delete;
  DraftFolder& operator=(const DraftFolder&) = delete;

  [[nodiscard]] const std::filesystem::path& path() const noexcept { return path_; }

 private:
  std::filesystem::path path_;
  int lock_ = -1;
  Leftover leftover_;
};

}  // namespace palpate
