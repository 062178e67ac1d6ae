// SPDX-License-Identifier: Apache-2.0
// apps/sculpt/saved_files.hpp: which files a session has written, so that it overwrites no other unasked. One thread.
#pragma once

#include <filesystem>
#include <set>

namespace palpate {

class SavedFiles {
 public:
  // Something lies there that this session has not put there. A look at the disk.
  [[nodiscard]] bool isForeign(const std::filesystem::path& file) const;
  void wrote(const std::filesystem::path& file);

 private:
  std::set<std::filesystem::path> files_;  // whole paths
};

}  // namespace palpate
