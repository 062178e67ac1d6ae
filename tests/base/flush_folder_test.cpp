// SPDX-License-Identifier: Apache-2.0
#include "base/flush_folder.hpp"

#include <cerrno>

#include <gtest/gtest.h>

#include "temporary_folder.hpp"
#include "tests/support/open_descriptors.hpp"

namespace palpate {
namespace flush_folder_test {

TEST(FlushFolder, FlushesOneAndNamesTheErrorOfWhatIsNone) {
  const TemporaryFolder folder;
  const long open = openDescriptors();
  errno = EIO;  // of something before
  EXPECT_EQ(flushFolder(folder.path()), 0);
  EXPECT_EQ(flushFolder(folder.path() / "nothing"), ENOENT);
  EXPECT_EQ(openDescriptors(), open);
}

// /proc is such a file system: fsync says EINVAL.
TEST(FlushFolder, AFileSystemThatDoesNotFlushFoldersIsNoError) {
  EXPECT_EQ(flushFolder("/proc/self"), 0);
}

}  // namespace flush_folder_test
}  // namespace palpate
