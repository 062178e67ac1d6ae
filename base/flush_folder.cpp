// SPDX-License-Identifier: Apache-2.0
#include "base/flush_folder.hpp"

#include <cerrno>

#include <fcntl.h>
#include <unistd.h>

namespace palpate {

int flushFolder(const std::filesystem::path& folder) {
  const int descriptor = open(folder.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC);
  if (descriptor < 0) return errno == EACCES ? 0 : errno;
  const int error = fsync(descriptor) == 0 ? 0 : errno;
  close(descriptor);
  return error == EINVAL || error == ENOTSUP || error == EROFS ? 0 : error;
}

}  // namespace palpate
