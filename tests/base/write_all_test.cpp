// SPDX-License-Identifier: Apache-2.0
#include "base/write_all.hpp"

#include <cerrno>
#include <string>

#include <fcntl.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include "file_size_limit.hpp"
#include "temporary_folder.hpp"

namespace palpate {
namespace write_all_test {

// At the limit the system writes a part and says how much; only the call after that one fails.
TEST(WriteAll, APartIsNotTheWhole) {
  const TemporaryFolder folder;
  const std::string name = folder.path() / "a";
  const int file = open(name.c_str(), O_WRONLY | O_CREAT | O_CLOEXEC, 0666);
  const FileSizeLimit limit(100);
  EXPECT_EQ(writeAll(file, std::string(60, 'x')), 0);
  EXPECT_EQ(writeAll(file, std::string(60, 'y')), EFBIG);
  close(file);
  EXPECT_EQ(contentsOf(name), std::string(60, 'x') + std::string(40, 'y'));
}

TEST(WriteAll, SaysWhatFailed) {
  const int full = open("/dev/full", O_WRONLY | O_CLOEXEC);
  EXPECT_EQ(writeAll(full, "x"), ENOSPC);
  close(full);
  EXPECT_EQ(writeAll(-1, "x"), EBADF);
  EXPECT_EQ(writeAll(-1, ""), 0);
}

}  // namespace write_all_test
}  // namespace palpate
