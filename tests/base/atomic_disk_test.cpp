// SPDX-License-Identifier: Apache-2.0
// A file gets its name when all of it is on the disk: after a crash of the machine the old one is there or the new one.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "base/atomic_file.hpp"
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

}  // namespace atomic_disk_test
}  // namespace palpate
