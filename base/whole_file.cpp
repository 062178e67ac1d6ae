// SPDX-License-Identifier: Apache-2.0
#include "base/whole_file.hpp"

#include <cerrno>
#include <cstring>

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/stat.h>
#include <unistd.h>

#include "base/byte_size.hpp"
#include "base/descriptor.hpp"
#include "base/error.hpp"

namespace palpate {

std::string wholeFile(const std::filesystem::path& file, const std::string& what, std::uint64_t most_bytes) {
  const std::string name = file.string();
  const Descriptor opened(open(file.c_str(), O_RDONLY | O_CLOEXEC | O_NONBLOCK | O_NOCTTY));
  if (!opened) {
    const int why = errno;
    const bool is_lack = why == EMFILE || why == ENFILE || why == ENOMEM;  // of this moment, whatever the file is
    // Else the disk or the network fails, and another moment may have it.
    const bool is_refused =
        why == ENOENT || why == ENOTDIR || why == ELOOP || why == ENAMETOOLONG || why == EACCES || why == EPERM;
    throw Error(is_lack      ? Error::Code::kOutOfMemory
                : is_refused ? Error::Code::kNotFound
                             : Error::Code::kIo,
                name, fmt::format("{} cannot be opened ({})", what, std::strerror(why)),
                is_lack      ? kFreeDescriptors
                : is_refused ? "check its name and rights"
                             : "see whether its disk can be reached");
  }
  struct stat facts {};
  if (fstat(opened.get(), &facts) != 0 || !S_ISREG(facts.st_mode))
    refuse(name, fmt::format("{} is no plain file", what),
           S_ISDIR(facts.st_mode) ? "name a file in this folder" : "name a file");
  if (static_cast<std::uint64_t>(facts.st_size) > most_bytes) {
    refuse(name,
           fmt::format("{} has {}, and may have {}", what, inMiB(static_cast<std::uint64_t>(facts.st_size)),
                       inMiB(most_bytes)),
           "name another file");
  }
  std::string content;
  while (content.size() <= most_bytes) {
    constexpr std::size_t kAtOnce = std::size_t{1} << 20U;
    const std::size_t before = content.size();
    content.resize(before + kAtOnce);
    const ssize_t count = read(opened.get(), content.data() + before, kAtOnce);
    const int why = errno;
    content.resize(before + static_cast<std::size_t>(std::max<ssize_t>(0, count)));
    if (count == 0) return content;
    if (count < 0 && why != EINTR) {
      throw Error(Error::Code::kIo, name, fmt::format("{} cannot be read ({})", what, std::strerror(why)),
                  "check the disk, or copy the file again");
    }
  }
  refuse(name, fmt::format("{} grew beyond {} while it was read", what, inMiB(most_bytes)), "wait until it is written");
}

}  // namespace palpate
