// SPDX-License-Identifier: Apache-2.0
#include "apps/console/standard_streams.hpp"

#include <cerrno>
#include <initializer_list>

#include <fcntl.h>
#include <unistd.h>

namespace palpate {

// In rising order, since open() gives the lowest number that is free.
void openClosedStreams() noexcept {
  for (const int descriptor : {STDIN_FILENO, STDOUT_FILENO, STDERR_FILENO}) {
    if (fcntl(descriptor, F_GETFD) >= 0 || errno != EBADF) continue;
    const int opened = open("/dev/null", descriptor == STDIN_FILENO ? O_WRONLY : O_RDONLY);
    if (opened >= 0 && opened != descriptor) {  // cannot be: those below are open
      dup2(opened, descriptor);
      close(opened);
    }
  }
}

}  // namespace palpate
