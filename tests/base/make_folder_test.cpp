// SPDX-License-Identifier: Apache-2.0
#include "base/make_folder.hpp"

#include <cerrno>
#include <fstream>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/resource.h>
#include <unistd.h>

#include "temporary_folder.hpp"

namespace palpate {
namespace make_folder_test {

using ::testing::ElementsAre;
using ::testing::IsEmpty;

TEST(MakeFolder, KnowsWhichFoldersGetAnEntry) {
  const TemporaryFolder folder;
  const std::filesystem::path top = folder.path();
  EXPECT_THAT(foldersThatGrow(top / "a" / "b" / "c"), ElementsAre(top, top / "a", top / "a" / "b"));
  EXPECT_THAT(foldersThatGrow(top / "a" / ""), ElementsAre(top));
  EXPECT_THAT(foldersThatGrow(top), IsEmpty());
  EXPECT_THAT(foldersThatGrow(top / ""), IsEmpty());
  EXPECT_THAT(foldersThatGrow("no_such/folder"), ElementsAre(".", "no_such"));
  EXPECT_THAT(foldersThatGrow("/"), IsEmpty());
}

TEST(MakeFolder, MakesEveryLevel) {
  const TemporaryFolder folder;
  EXPECT_EQ(makeFolder(folder.path() / "a" / "b"), 0);
  EXPECT_TRUE(std::filesystem::is_directory(folder.path() / "a" / "b"));
  EXPECT_EQ(makeFolder(folder.path() / "a" / "b"), 0);
}

// No file more may be opened, a folder to flush neither: whether one was flushed shows.
TEST(MakeFolder, FlushesTheParentsOfWhatIsNewAndNoOthers) {
  const TemporaryFolder folder;
  const int next = dup(STDERR_FILENO);  // the lowest number that is free
  close(next);
  rlimit before{};
  getrlimit(RLIMIT_NOFILE, &before);
  const rlimit none{static_cast<rlim_t>(next), before.rlim_max};
  setrlimit(RLIMIT_NOFILE, &none);
  const int made = makeFolder(folder.path() / "a");
  const int there = makeFolder(folder.path());
  setrlimit(RLIMIT_NOFILE, &before);
  EXPECT_EQ(made, EMFILE);
  EXPECT_EQ(there, 0);
}

TEST(MakeFolder, SaysWhyItCannot) {
  const TemporaryFolder folder;
  std::ofstream(folder.path() / "file") << "x";
  EXPECT_EQ(makeFolder(folder.path() / "file" / "a"), ENOTDIR);
}

}  // namespace make_folder_test
}  // namespace palpate
