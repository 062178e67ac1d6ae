// SPDX-License-Identifier: Apache-2.0
#include "base/draft_folder.hpp"

#include <csignal>
#include <fstream>
#include <memory>
#include <system_error>

#include <gtest/gtest.h>
#include <sys/wait.h>
#include <unistd.h>

#include "temporary_folder.hpp"
#include "tests/support/open_descriptors.hpp"

namespace palpate {
namespace draft_folder_test {

class DraftFolders : public testing::Test {
 protected:
  [[nodiscard]] std::filesystem::path file(const std::string& name) const { return folder_.path() / name; }
  void write(const std::filesystem::path& name) const { std::ofstream(name) << "text"; }
  TemporaryFolder folder_;
};

TEST_F(DraftFolders, GoesWithItsOwner) {
  {
    const DraftFolder drafts(folder_.path(), ".palpate-");
    EXPECT_TRUE(std::filesystem::is_directory(drafts.path()));
    EXPECT_EQ(drafts.path().parent_path(), folder_.path());
    write(drafts.path() / "a");
  }
  EXPECT_EQ(folder_.files(), 0);
}

TEST_F(DraftFolders, OfOneParentDoNotMeet) {
  const DraftFolder first(folder_.path(), ".palpate-");
  write(first.path() / "a");
  const DraftFolder second(folder_.path(), ".palpate-");
  EXPECT_NE(first.path(), second.path());
  EXPECT_TRUE(std::filesystem::exists(first.path() / "a"));  // not taken for what somebody left
}

// Another process is killed: until then its folder stays, then it goes.
TEST_F(DraftFolders, WhatAKilledProcessLeftGoesWithTheNext) {
  const pid_t child = fork();
  if (child == 0) {
    const DraftFolder drafts(folder_.path(), ".palpate-");
    std::filesystem::create_directory(drafts.path() / "inner");
    write(drafts.path() / "inner" / "a");
    write(file("ready"));
    for (;;) pause();
  }
  while (contentsOf(file("ready")) != "text") usleep(1000);
  const long open = openDescriptors();
  { const DraftFolder meanwhile(folder_.path(), ".palpate-"); }
  EXPECT_EQ(folder_.files(), 2);
  EXPECT_EQ(openDescriptors(), open);
  kill(child, SIGKILL);
  waitpid(child, nullptr, 0);
  EXPECT_EQ(folder_.files(), 2);
  { const DraftFolder next(folder_.path(), ".palpate-"); }
  EXPECT_EQ(folder_.files(), 1);
}

TEST_F(DraftFolders, OtherThingsStay) {
  for (const char* name : {".palpate-abcde", ".palpate-abcdefg", ".palpate-abc.ef", "palpate-abcdef", ".palpate-"})
    std::filesystem::create_directory(file(name));
  write(file(".palpate-abcdef"));  // a file
  std::filesystem::create_directory(file("mine"));
  write(file("mine/a"));
  std::filesystem::create_directory_symlink("mine", file(".palpate-ABCDEF"));
  { const DraftFolder drafts(folder_.path(), ".palpate-"); }
  EXPECT_EQ(folder_.files(), 8);
  EXPECT_TRUE(std::filesystem::exists(file("mine/a")));
}

TEST_F(DraftFolders, WhereNoneCanBeMadeIsAnError) {
  try {
    const DraftFolder drafts(file("nowhere"), ".palpate-");
    FAIL() << "no error";
  } catch (const std::system_error& error) {
    EXPECT_EQ(error.code(), std::errc::no_such_file_or_directory);
  }
}

}  // namespace draft_folder_test
}  // namespace palpate
