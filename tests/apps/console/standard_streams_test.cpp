// SPDX-License-Identifier: Apache-2.0
#include "apps/console/standard_streams.hpp"

#include <cerrno>

#include <fcntl.h>
#include <gtest/gtest.h>

#include "in_child.hpp"

namespace palpate {
namespace standard_streams_test {

// Every combination: afterwards all three are open, so no file takes their place, and those that were open are as they
// were.
TEST(StandardStreams, AreOpenWhateverWasClosed) {
  for (int closed = 0; closed < 8; ++closed) {
    const Ended ended = inChild([&] {
      int status = 0;
      for (int stream = 0; stream < 3; ++stream) {
        const int file = open("/dev/zero", O_RDWR);
        dup2(file, stream);
        close(file);
      }
      for (int stream = 0; stream < 3; ++stream) {
        if ((closed >> stream & 1) != 0) close(stream);
      }
      openClosedStreams();
      const int next = open("/dev/null", O_RDWR);
      if (next <= 2) status = 1;
      for (int stream = 0; stream < 3; ++stream) {
        char byte = 1;
        const bool was_closed = (closed >> stream & 1) != 0;
        const ssize_t done = stream == 0 ? read(stream, &byte, 1) : write(stream, &byte, 1);
        // What goes to a closed stream is lost, and who cares can know it.
        if (was_closed ? done != -1 || errno != EBADF : done != 1) status = 2 + stream;
      }
      _exit(status);
    });
    EXPECT_EQ(ended.status, 0) << closed;
  }
}

}  // namespace standard_streams_test
}  // namespace palpate
