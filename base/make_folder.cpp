// SPDX-License-Identifier: Apache-2.0
#include "base/make_folder.hpp"

#include "base/flush_folder.hpp"

namespace palpate {

namespace fs = std::filesystem;

std::vector<fs::path> foldersThatGrow(const fs::path& folder) {
  std::vector<fs::path> parents;
  fs::path level;
  for (const fs::path& name : folder) {
    if (name.empty()) continue;  // behind a last slash
    const fs::path parent = level.empty() ? "." : level;
    level /= name;
    std::error_code ignored;
    if (!fs::exists(level, ignored)) parents.push_back(parent);
  }
  return parents;
}

int makeFolder(const fs::path& folder) {
  const std::vector<fs::path> parents = foldersThatGrow(folder);
  std::error_code error;
  fs::create_directories(folder, error);
  if (error) return error.value();
  for (const fs::path& parent : parents) {
    if (const int unflushed = flushFolder(parent); unflushed != 0) return unflushed;
  }
  return 0;
}

}  // namespace palpate
