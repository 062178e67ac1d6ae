// SPDX-License-Identifier: Apache-2.0
#include "base/durable_io.hpp"

#include <cerrno>
#include <fstream>
#include <string>

#include <fcntl.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/stat.h>
#include <unistd.h>

#include "file_size_limit.hpp"
#include "temporary_folder.hpp"
#include "tests/support/few_descriptors.hpp"
#include "tests/support/open_descriptors.hpp"

namespace palpate {
namespace durable_io_test {

using ::testing::ElementsAre;
using ::testing::IsEmpty;

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

TEST(MakeFolder, KnowsTheParentsOfNewLevels) {
  const TemporaryFolder folder;
  const std::filesystem::path& top = folder.path();
  EXPECT_THAT(parentsOfNewLevels(top / "a" / "b" / "c"), ElementsAre(top, top / "a", top / "a" / "b"));
  EXPECT_THAT(parentsOfNewLevels(top / "a" / ""), ElementsAre(top));
  EXPECT_THAT(parentsOfNewLevels(top), IsEmpty());
  EXPECT_THAT(parentsOfNewLevels(top / ""), IsEmpty());
  EXPECT_THAT(parentsOfNewLevels("no_such/folder"), ElementsAre(".", "no_such"));
  EXPECT_THAT(parentsOfNewLevels("/"), IsEmpty());
}

TEST(MakeFolder, MakesEveryLevel) {
  const TemporaryFolder folder;
  EXPECT_EQ(makeFolder(folder.path() / "a" / "b"), 0);
  EXPECT_TRUE(std::filesystem::is_directory(folder.path() / "a" / "b"));
  EXPECT_EQ(makeFolder(folder.path() / "a" / "b"), 0);
}

// No file more may be opened, a folder to flush neither: whether one was flushed shows.
TEST(MakeFolder, PrivateLevelsAreTheirOwnersAloneAndOthersStay) {
  TemporaryFolder folder;
  const mode_t before = umask(0);
  const std::filesystem::path open = folder.path() / "open", inside = open / "a" / "b";
  ASSERT_EQ(makeFolder(open), 0);
  ASSERT_EQ(makeFolder(inside, Rights::kPrivate), 0);
  ASSERT_EQ(makeFolder(inside, Rights::kPrivate), 0);  // it is there
  umask(before);
  const auto rights = [](const std::filesystem::path& of) {
    return static_cast<unsigned>(std::filesystem::status(of).permissions());
  };
  EXPECT_EQ(rights(open), 0777U);
  EXPECT_EQ(rights(inside.parent_path()), 0700U);
  EXPECT_EQ(rights(inside), 0700U);
}

TEST(MakeFolder, FlushesTheParentsOfWhatIsNewAndNoOthers) {
  const TemporaryFolder folder;
  int made = 0, there = 0;
  {
    const FewDescriptors none;
    made = makeFolder(folder.path() / "a");
    there = makeFolder(folder.path());
  }
  EXPECT_EQ(made, EMFILE);
  EXPECT_EQ(there, 0);
}

TEST(MakeFolder, SaysWhyItCannot) {
  const TemporaryFolder folder;
  std::ofstream(folder.path() / "file") << "x";
  EXPECT_EQ(makeFolder(folder.path() / "file" / "a"), ENOTDIR);
}

}  // namespace durable_io_test
}  // namespace palpate
