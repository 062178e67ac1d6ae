// SPDX-License-Identifier: Apache-2.0
// A file gets its name when all of it is on the disk: after a crash of the machine the old one is there or the new one.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "base/atomic_file.hpp"
#include "base/durable_io.hpp"
#include "base/error.hpp"
#include "disk_watch.hpp"
#include "temporary_folder.hpp"

namespace palpate {
namespace atomic_disk_test {

using ::testing::HasSubstr;

TEST(AtomicDisk, AFileIsFlushedBeforeItIsNamed) {
  const TemporaryFolder folder;
  const std::string file = folder.path() / "a.txt";
  for (const std::size_t size : {1, 200'000}) {
    disk_watch::named.clear();
    writeFileAtomically(file, std::string(size, 'x'));
    ASSERT_TRUE(disk_watch::named.contains(file));
    EXPECT_EQ(disk_watch::named.at(file), 1) << size;
    EXPECT_EQ(disk_watch::flushedBytes(file), static_cast<off_t>(size));
  }
}

TEST(AtomicDisk, ADiskThatFailsLeavesTheOlderFile) {
  const TemporaryFolder folder;
  const std::filesystem::path file = folder.path() / "a.txt";
  writeFileAtomically(file, "old");
  disk_watch::error_of_next_flush = EIO;
  try {
    writeFileAtomically(file, "new");
    FAIL() << "no error";
  } catch (const Error& error) {
    EXPECT_EQ(error.code(), Error::Code::kIo);
    EXPECT_THAT(error.what(), HasSubstr("cannot be written (Input/output error)"));
  }
  EXPECT_EQ(contentsOf(file), "old");
  EXPECT_EQ(folder.files(), 1);
}

// Not every file system flushes folders.
TEST(AtomicDisk, AFolderThatIsNotFlushedIsNoErrorButABadDiskIs) {
  const TemporaryFolder folder;
  for (const auto& [error, told] : {std::pair(EINVAL, 0), {ENOTSUP, 0}, {EROFS, 0}, {EIO, EIO}, {ENOSPC, ENOSPC}}) {
    disk_watch::error_of_next_flush = error;
    EXPECT_EQ(flushFolder(folder.path()), told);
    EXPECT_EQ(disk_watch::error_of_next_flush, 0);
  }
  disk_watch::error_of_next_flush = EIO;
  EXPECT_EQ(makeFolder(folder.path() / "a"), EIO);
}

}  // namespace atomic_disk_test
}  // namespace palpate
