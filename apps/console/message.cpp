// SPDX-License-Identifier: Apache-2.0
#include "apps/console/message.hpp"

#include <cerrno>
#include <initializer_list>

#include <fcntl.h>
#include <unistd.h>

#include "base/outside_text.hpp"

namespace palpate {
namespace {

int first_error = 0;  // of standard output

void note(bool failed) noexcept {
  if (failed && first_error == 0) first_error = errno != 0 ? errno : EIO;
}

}  // namespace

void writeMessage(std::FILE* stream, std::string_view text) noexcept {
  std::fwrite(text.data(), 1, text.size(), stream);
  std::fflush(stream);
  std::clearerr(stream);  // the next one is tried again: a disk may have room by then
}

void tellUser(std::string_view text) noexcept {
  try {
    writeMessage(stderr, "palpate: " + oneLine(std::string(text)) + "\n");
  } catch (...) {  // no memory for the line
    writeMessage(stderr, text);
  }
}

void printText(std::string_view text) noexcept {
  errno = 0;
  note(std::fwrite(text.data(), 1, text.size(), stdout) < text.size());
}

int resultError() noexcept {
  errno = 0;
  note(std::fflush(stdout) != 0 || std::ferror(stdout) != 0);
  return first_error;
}

// In rising order, since open() gives the lowest number that is free.
void openClosedStreams() noexcept {
  for (const int descriptor : {STDIN_FILENO, STDOUT_FILENO, STDERR_FILENO}) {
    if (fcntl(descriptor, F_GETFD) >= 0 || errno != EBADF) continue;
    const int opened = open("/dev/null", descriptor == STDIN_FILENO ? O_WRONLY : O_RDONLY);
    if (opened >= 0 && opened != descriptor) {  // cannot happen: all lower descriptors are open
      dup2(opened, descriptor);
      close(opened);
    }
  }
}

}  // namespace palpate
