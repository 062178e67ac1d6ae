// SPDX-License-Identifier: Apache-2.0
#include "base/atomic_file.hpp"

#include <stdexcept>
#include <utility>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/stat.h>
#include <unistd.h>

#include "base/error.hpp"
#include "file_size_limit.hpp"
#include "temporary_folder.hpp"
#include "tests/support/as_nobody.hpp"

namespace palpate {
namespace atomic_file_test {

using ::testing::HasSubstr;

const std::uint64_t kWrittenAtStart = filesWritten();  // before any test

template <typename Action>
void expectIoError(Action action, const std::string& words) {
  try {
    action();
    FAIL() << "no error";
  } catch (const Error& error) {
    EXPECT_EQ(error.code(), Error::Code::kIo);
    EXPECT_THAT(error.what(), HasSubstr(words));
  }
}

TEST(AtomicFile, WritesTheWholeTextAndNothingElse) {
  TemporaryFolder folder;
  const std::string text(200'000, 'x');
  writeFileAtomically(folder.path() / "a.txt", text);
  EXPECT_EQ(contentsOf(folder.path() / "a.txt"), text);
  EXPECT_EQ(folder.files(), 1);
}

// A system call for each 64 KiB: less stays in memory.
TEST(AtomicFile, GathersSmallPieces) {
  TemporaryFolder folder;
  AtomicFile file(folder.path() / "a.txt");
  const std::filesystem::path part = std::filesystem::directory_iterator(folder.path())->path();
  file.write(std::string(65534, 'x'));
  file.write("x");
  EXPECT_EQ(std::filesystem::file_size(part), 0U);
  file.write("x");
  EXPECT_EQ(std::filesystem::file_size(part), 65536U);
}

TEST(SameFile, IsSeenThroughEverySpelling) {
  TemporaryFolder folder;
  const std::filesystem::path a = folder.path() / "a", b = folder.path() / "b", link = folder.path() / "link";
  EXPECT_TRUE(sameFile("a", "./a"));  // neither is there
  EXPECT_TRUE(sameFile(a, folder.path() / "x" / ".." / "a"));
  EXPECT_FALSE(sameFile(a, b));
  std::filesystem::create_symlink(a, link);
  EXPECT_TRUE(sameFile(a, link));
  EXPECT_FALSE(sameFile(b, link));
  writeFileAtomically(a, "a");
  EXPECT_TRUE(sameFile(a, link));
  std::filesystem::create_hard_link(a, b);
  EXPECT_TRUE(sameFile(a, b));
}

TEST(SameFile, MayNotTakeTwoResults) {
  EXPECT_NO_THROW(checkOutputsDiffer({"", "a", "", "b", ""}));
  try {
    checkOutputsDiffer({"a", "b", "", "./a"});
    FAIL() << "no error";
  } catch (const Error& error) {
    EXPECT_EQ(error.code(), Error::Code::kBadInput);
    EXPECT_THAT(error.what(), HasSubstr("./a: it is named for two of the outputs"));
  }
}

TEST(AtomicFile, ReplacesAnOlderFile) {
  TemporaryFolder folder;
  writeFileAtomically(folder.path() / "a.txt", "old");
  writeFileAtomically(folder.path() / "a.txt", "new");
  EXPECT_EQ(contentsOf(folder.path() / "a.txt"), "new");
}

unsigned rightsOf(const std::filesystem::path& file) {
  return static_cast<unsigned>(std::filesystem::status(file).permissions());
}

// From before the first byte on, and through a link.
TEST(AtomicFile, AReplacedFileKeepsItsRights) {
  TemporaryFolder folder;
  const std::filesystem::path target = folder.path() / "a.txt", link = folder.path() / "link";
  writeFileAtomically(target, "old");
  std::filesystem::create_symlink(target, link);
  for (const unsigned rights : {0600U, 0640U, 0664U, 0444U, 0777U}) {
    for (const auto& [name, asked] : {std::pair(target, Rights::kUsual), std::pair(link, Rights::kPrivate)}) {
      std::filesystem::permissions(target, static_cast<std::filesystem::perms>(rights));
      AtomicFile file(name, asked);
      for (const auto& entry : std::filesystem::directory_iterator(folder.path())) {
        if (entry.is_symlink()) continue;
        EXPECT_EQ(rightsOf(entry.path()), rights) << entry.path();
      }
      file.write("new");
      file.commit();
      EXPECT_EQ(rightsOf(target), rights);
    }
  }
}

TEST(AtomicFile, APrivateFileIsItsOwnersAloneFromTheStart) {
  TemporaryFolder folder;
  const mode_t before = umask(0);
  for (const auto& [rights, wanted] : {std::pair(Rights::kPrivate, 0600U), std::pair(Rights::kUsual, 0666U)}) {
    const std::filesystem::path target = folder.path() / std::to_string(wanted);
    AtomicFile file(target, rights);
    for (const auto& entry : std::filesystem::directory_iterator(folder.path())) {
      if (!entry.path().filename().native().starts_with(std::to_string(wanted))) continue;
      EXPECT_EQ(rightsOf(entry.path()), wanted) << entry.path();
    }
    file.commit();
    EXPECT_EQ(rightsOf(target), wanted);
  }
  umask(before);
}

TEST(AtomicFile, TakesNamesAsLongAsTheFileSystemDoes) {
  TemporaryFolder folder;
  for (const std::size_t length : {1, 200, 229, 230, 231, 240, 254, 255}) {
    const std::filesystem::path target = folder.path() / std::string(length, 'n');
    writeFileAtomically(target, "text");
    EXPECT_EQ(contentsOf(target), "text");
  }
  EXPECT_EQ(folder.files(), 8);
  expectIoError([&] { writeFileAtomically(folder.path() / std::string(256, 'n'), ""); }, "");
}

TEST(AtomicFile, AnExceptionOnTheWayLeavesTheOlderFile) {
  TemporaryFolder folder;
  writeFileAtomically(folder.path() / "a.txt", "old");
  try {
    AtomicFile file(folder.path() / "a.txt");
    file.write(std::string(100'000, 'n'));
    throw std::runtime_error("stop");
  } catch (const std::runtime_error&) {
  }
  EXPECT_EQ(contentsOf(folder.path() / "a.txt"), "old");
  EXPECT_EQ(folder.files(), 1);
}

TEST(AtomicFile, AFullDiskIsAnErrorAndLeavesNothing) {
  TemporaryFolder folder;
  const FileSizeLimit limit(10'000);
  expectIoError([&] { writeFileAtomically(folder.path() / "a.txt", std::string(100'000, 'x')); }, "make room");
  EXPECT_EQ(folder.files(), 0);
}

TEST(AtomicFile, AFullDiskLeavesTheOlderFile) {
  TemporaryFolder folder;
  writeFileAtomically(folder.path() / "a.txt", "old");
  const FileSizeLimit limit(10'000);
  expectIoError([&] { writeFileAtomically(folder.path() / "a.txt", std::string(100'000, 'x')); },
                "a.txt: cannot be written");
  EXPECT_EQ(contentsOf(folder.path() / "a.txt"), "old");
  EXPECT_EQ(folder.files(), 1);
}

TEST(AtomicFile, RefusesAMissingFolder) {
  TemporaryFolder folder;
  expectIoError([&] { writeFileAtomically(folder.path() / "no" / "a.txt", "x"); }, "make the folder first");
}

TEST(AtomicFile, RefusesAnUnwritableFolder) {
  TemporaryFolder folder;
  std::filesystem::permissions(folder.path(), std::filesystem::perms(0555));
  const AsNobody nobody;
  ASSERT_TRUE(nobody.isSet());
  expectIoError([&] { writeFileAtomically(folder.path() / "a.txt", "x"); }, "check the permissions");
  EXPECT_EQ(folder.files(), 0);
}

// What a shell led elsewhere, as with >> log: the log would be replaced by one result.
TEST(AtomicFile, RefusesAStreamOfItsProgram) {
  for (const char* stream : {"/dev/stdout", "/dev/stderr", "/dev/fd/1", "/proc/self/fd/1"}) {
    try {
      const AtomicFile file(stream);
      FAIL() << stream;
    } catch (const Error& error) {
      EXPECT_EQ(error.code(), Error::Code::kIo);
    }
  }
}

TEST(AtomicFile, RefusesToReplaceADevice) {
  expectIoError([] { writeFileAtomically("/dev/full", "x"); }, "not a plain file");
  EXPECT_TRUE(std::filesystem::is_character_file("/dev/full"));
}

// Whoever made a link has the file elsewhere on purpose: on a larger disk, say.
TEST(AtomicFile, WritesThroughSymbolicLinks) {
  namespace fs = std::filesystem;
  TemporaryFolder folder;
  const fs::path real = folder.path() / "real", other = folder.path() / "other";
  fs::create_directory(real);
  fs::create_directory(other);
  writeFileAtomically(real / "a.txt", "old");
  fs::create_symlink("../real/a.txt", other / "relative.txt");  // from the link's own folder
  fs::create_symlink(real / "a.txt", folder.path() / "absolute.txt");
  fs::create_symlink("other/relative.txt", folder.path() / "chain.txt");
  for (const fs::path& link : {other / "relative.txt", folder.path() / "absolute.txt", folder.path() / "chain.txt"}) {
    writeFileAtomically(link, link.string());
    EXPECT_TRUE(fs::is_symlink(fs::symlink_status(link))) << link;
    EXPECT_FALSE(fs::is_symlink(fs::symlink_status(real / "a.txt")));
    EXPECT_EQ(contentsOf(real / "a.txt"), link.string());
  }
  EXPECT_EQ(std::distance(fs::directory_iterator(real), {}), 1);
  EXPECT_EQ(std::distance(fs::directory_iterator(other), {}), 1);
}

// As many as Linux follows: 40.
TEST(AtomicFile, WritesThroughALongChainOfLinks) {
  namespace fs = std::filesystem;
  TemporaryFolder folder;
  const auto link = [&](int n) { return folder.path() / ("link" + std::to_string(n)); };
  fs::create_symlink("a.txt", link(1));
  for (int n = 2; n <= 40; ++n) fs::create_symlink(link(n - 1).filename(), link(n));
  writeFileAtomically(link(40), "text");
  for (int n = 1; n <= 40; ++n) EXPECT_TRUE(fs::is_symlink(fs::symlink_status(link(n)))) << n;
  EXPECT_EQ(contentsOf(folder.path() / "a.txt"), "text");
}

TEST(AtomicFile, MakesTheFileThatALinkPointsAt) {
  namespace fs = std::filesystem;
  TemporaryFolder folder;
  fs::create_symlink("new.txt", folder.path() / "link.txt");
  {
    AtomicFile file(folder.path() / "link.txt");
    file.write("text");
  }
  EXPECT_EQ(folder.files(), 1);  // without commit nothing is there
  writeFileAtomically(folder.path() / "link.txt", "text");
  EXPECT_EQ(contentsOf(folder.path() / "new.txt"), "text");
  EXPECT_TRUE(fs::is_symlink(fs::symlink_status(folder.path() / "link.txt")));
}

TEST(AtomicFile, RefusesLinksThatLeadNowhere) {
  namespace fs = std::filesystem;
  TemporaryFolder folder;
  fs::create_symlink("b.txt", folder.path() / "a.txt");
  fs::create_symlink("a.txt", folder.path() / "b.txt");
  fs::create_symlink("none/c.txt", folder.path() / "c.txt");
  fs::create_symlink("/dev/full", folder.path() / "d.txt");
  expectIoError([&] { writeFileAtomically(folder.path() / "a.txt", "x"); }, "a.txt: its symbolic links go round");
  expectIoError([&] { writeFileAtomically(folder.path() / "c.txt", "x"); }, "c.txt: cannot be created");
  expectIoError([&] { writeFileAtomically(folder.path() / "d.txt", "x"); }, "not a plain file");
  EXPECT_EQ(folder.files(), 4);
}

TEST(AtomicFile, CountsWhatIsWhole) {
  TemporaryFolder folder;
  const std::uint64_t before = filesWritten();
  { AtomicFile unfinished(folder.path() / "a.txt"); }
  EXPECT_EQ(filesWritten(), before);
  writeFileAtomically(folder.path() / "a.txt", "x");
  EXPECT_EQ(filesWritten(), before + 1);
  EXPECT_EQ(kWrittenAtStart, 0U);
}

TEST(AtomicFile, IsTriedWithoutWriting) {
  TemporaryFolder folder;
  std::ofstream(folder.path() / "old.txt") << "old";
  checkWritable(folder.path() / "old.txt");
  checkWritable(folder.path() / "new.txt");
  EXPECT_EQ(contentsOf(folder.path() / "old.txt"), "old");
  EXPECT_EQ(folder.files(), 1);
  expectIoError([&] { checkWritable(folder.path() / "none" / "a.txt"); }, "cannot be created");
}

TEST(AtomicFile, RefusesToReplaceAFolder) {
  TemporaryFolder folder;
  expectIoError([&] { writeFileAtomically(folder.path(), "x"); }, "not a plain file");
}

}  // namespace atomic_file_test
}  // namespace palpate
