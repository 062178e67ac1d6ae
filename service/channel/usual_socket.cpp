// SPDX-License-Identifier: Apache-2.0
#include "service/channel/usual_socket.hpp"

#include <cerrno>
#include <cstring>
#include <filesystem>

#include <sys/stat.h>
#include <unistd.h>

#include "base/error.hpp"
#include "base/formatted.hpp"
#include "base/user_folders.hpp"

namespace palpate {

namespace fs = std::filesystem;

std::string usualSocket() {
  fs::path folder = runtimeFolder();
  if (folder.empty()) folder = formatted("/tmp/palpate-{}", geteuid());
  return (folder / "service.sock").string();
}

void makeSocketFolder(const std::string& socket) {
  const fs::path folder = fs::absolute(socket).parent_path();
  std::error_code failed;
  fs::create_directories(folder.parent_path(), failed);
  if (mkdir(folder.c_str(), S_IRWXU) != 0 && errno != EEXIST)
    throw Error(Error::Code::kIo, folder.string(), formatted("it cannot be made ({})", std::strerror(errno)),
                "name another socket with --socket");
  struct stat facts {};
  const bool is_known = lstat(folder.c_str(), &facts) == 0;
  // In a folder that all may write to, somebody else may have been first.
  if (socket == usualSocket() && (!is_known || !S_ISDIR(facts.st_mode) || facts.st_uid != geteuid()))
    throw Error(Error::Code::kIo, folder.string(), "it is not this user's folder", "name another socket with --socket");
}

}  // namespace palpate
