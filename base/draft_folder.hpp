// SPDX-License-Identifier: Apache-2.0
// base/draft_folder.hpp: a folder for what is not finished, PARENT/PREFIXxxxxxx, that goes with its owner.
//
// As with files (base/part_file.hpp) its owner holds a lock on it, which ends with the process, however that ends: who
// makes the next one with this prefix in this parent removes what killed processes left there. Where a file system has
// no locks nothing is removed. Any thread. Cost: reading the names in the parent.
#pragma once

#include <filesystem>
#include <string>

#include "base/leftover.hpp"

namespace palpate {

class DraftFolder {
 public:
  // Throws std::system_error, without words of its own, where none can be made.
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
