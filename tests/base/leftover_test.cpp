// SPDX-License-Identifier: Apache-2.0
#include "base/leftover.hpp"

#include <csignal>
#include <fstream>
#include <functional>
#include <thread>

#include <gtest/gtest.h>
#include <sys/wait.h>
#include <unistd.h>

#include "temporary_folder.hpp"

namespace palpate {
namespace {

class Leftovers : public testing::Test {
 protected:
  [[nodiscard]] std::filesystem::path file(const std::string& name) const { return folder_.path() / name; }
  void write(const std::string& name) const { std::ofstream(file(name)) << name; }
  [[nodiscard]] bool exists(const std::string& name) const { return std::filesystem::exists(file(name)); }

  // In a process of its own, whose last moment it is.
  static void inChild(const std::function<void()>& work) {
    const pid_t child = fork();
    if (child == 0) {
      work();
      endLeftovers();
      _exit(0);
    }
    int status = 0;
    waitpid(child, &status, 0);
    EXPECT_TRUE(WIFEXITED(status) && WEXITSTATUS(status) == 0);
  }
  TemporaryFolder folder_;
};

TEST_F(Leftovers, FilesAndFoldersOfDraftsGo) {
  write("a");
  std::filesystem::create_directories(file("drafts/inner"));
  write("drafts/inner/b");
  inChild([&] {
    static const Leftover a = Leftover::file(file("a"));
    static const Leftover drafts = Leftover::folder(file("drafts"));
  });
  EXPECT_EQ(folder_.files(), 0);
}

TEST_F(Leftovers, WhatWasReleasedStays) {
  for (const char* name : {"renamed", "owned", "moved"}) write(name);
  inChild([&] {
    static Leftover renamed = Leftover::file(file("renamed"));
    renamed.release();
    { const Leftover owned = Leftover::file(file("owned")); }
    Leftover from = Leftover::file(file("moved"));
    static const Leftover to = std::move(from);  // one thing, not two
  });
  EXPECT_TRUE(exists("renamed"));
  EXPECT_TRUE(exists("owned"));
  EXPECT_FALSE(exists("moved"));
}

// Folders that were made on the way to a result, from the inside out; not those that hold what somebody put there.
TEST_F(Leftovers, FoldersThatAreEmptyThenGoWithWhatIsInThem) {
  std::filesystem::create_directories(file("a/b"));
  std::filesystem::create_directories(file("c"));
  write("a/b/draft");
  write("c/mine");
  inChild([&] {
    static const Leftover a = Leftover::emptyFolder(file("a")), b = Leftover::emptyFolder(file("a/b"));
    static const Leftover draft = Leftover::file(file("a/b/draft"));
    static const Leftover c = Leftover::emptyFolder(file("c"));
  });
  EXPECT_FALSE(exists("a"));
  EXPECT_TRUE(exists("c/mine"));
}

TEST_F(Leftovers, ANameIsThatOfTheFolderInWhichItWasGiven) {
  write("a");
  inChild([&] {
    if (chdir(folder_.path().c_str()) != 0) return;
    static const Leftover a = Leftover::file("a");
    if (chdir("/") != 0) return;
  });
  EXPECT_FALSE(exists("a"));
}

// The grandchild holds the writing end of a pipe, which is closed only when it has ended.
TEST_F(Leftovers, ProcessesAreKilled) {
  int ends[2];
  ASSERT_EQ(pipe(ends), 0);
  inChild([&] {
    const pid_t grandchild = fork();
    if (grandchild == 0) {
      for (;;) pause();
    }
    static const Leftover process = Leftover::process(grandchild);
  });
  close(ends[1]);
  char byte = 0;
  EXPECT_EQ(read(ends[0], &byte, 1), 0);
  close(ends[0]);
}

// A thread that would make another one after the end waits for ever: its file never comes.
TEST_F(Leftovers, NothingNewIsMadeAfterTheEnd) {
  inChild([&] {
    endLeftovers();
    std::thread([&] {
      const Leftover late = Leftover::file(file("late"));
      write("late");
    }).detach();
    std::this_thread::sleep_for(std::chrono::milliseconds(50));
    _exit(0);
  });
  EXPECT_FALSE(exists("late"));
}

}  // namespace
}  // namespace palpate
