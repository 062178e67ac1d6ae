// SPDX-License-Identifier: Apache-2.0
#include "base/durable_io.hpp"

#include <cerrno>

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

namespace palpate {

namespace fs = std::filesystem;

int writeAll(int descriptor, std::string_view bytes) noexcept {
  while (!bytes.empty()) {
    const ssize_t written = ::write(descriptor, bytes.data(), bytes.size());
    if (written < 0 && errno == EINTR) continue;
    if (written < 0) return errno;
    bytes.remove_prefix(static_cast<std::size_t>(written));
  }
  return 0;
}

int flushFolder(const fs::path& folder) {
  const int descriptor = open(folder.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC);
  if (descriptor < 0) return errno == EACCES ? 0 : errno;
  const int error = fsync(descriptor) == 0 ? 0 : errno;
  close(descriptor);
  return error == EINVAL || error == ENOTSUP || error == EROFS ? 0 : error;
}

std::vector<fs::path> parentsOfNewLevels(const fs::path& folder) {
  std::vector<fs::path> parents;
  fs::path level;
  for (const fs::path& name : folder) {
    if (name.empty()) continue;  // after a trailing slash
    const fs::path parent = level.empty() ? "." : level;
    level /= name;
    std::error_code ignored;
    if (!fs::exists(level, ignored)) parents.push_back(parent);
  }
  return parents;
}

int makeFolder(const fs::path& folder, Rights rights) {
  const std::vector<fs::path> parents = parentsOfNewLevels(folder);
  std::error_code error;
  if (rights == Rights::kPrivate) {
    fs::path level;
    for (const fs::path& name : folder) {
      level /= name;
      if (!name.empty() && mkdir(level.c_str(), 0700) != 0 && errno != EEXIST) return errno;
    }
  }
  fs::create_directories(folder, error);  // what is there already is a folder, or the error says what it is
  if (error) return error.value();
  for (const fs::path& parent : parents) {
    if (const int unflushed = flushFolder(parent); unflushed != 0) return unflushed;
  }
  return 0;
}

}  // namespace palpate
