// SPDX-License-Identifier: Apache-2.0
#include "base/write_all.hpp"

#include <cerrno>

#include <unistd.h>

namespace palpate {

int writeAll(int descriptor, std::string_view bytes) noexcept {
  while (!bytes.empty()) {
    const ssize_t written = ::write(descriptor, bytes.data(), bytes.size());
    if (written < 0 && errno == EINTR) continue;
    if (written < 0) return errno;
    bytes.remove_prefix(static_cast<std::size_t>(written));
  }
  return 0;
}

}  // namespace palpate
