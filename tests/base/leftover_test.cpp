// SPDX-License-Identifier: Apache-2.0
#include "base/leftover.hpp"

#include <csignal>
#include <fstream>
#include <functional>
#include <thread>
#include <vector>

#include <gtest/gtest.h>
#include <sys/wait.h>
#include <unistd.h>

#include "base/atomic_file.hpp"
#include "base/draft_folder.hpp"
#include "temporary_folder.hpp"

namespace palpate {
namespace leftover_test {

class Leftovers : public testing::Test {
 protected:
  [[nodiscard]] std::filesystem::path file(const std::string& name) const { return folder_.path() / name; }
  void write(const std::string& name) const { std::ofstream(file(name)) << name; }
  // A file that is there.
  [[nodiscard]] static Leftover leftFile(const std::filesystem::path& name) {
    return Leftover::file([&] { return name; });
  }
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
    static const Leftover a = leftFile(file("a"));
    static const Leftover drafts = Leftover::folder([&] { return file("drafts"); });
  });
  EXPECT_EQ(folder_.files(), 0);
}

TEST_F(Leftovers, WhatWasReleasedStays) {
  for (const char* name : {"renamed", "owned", "moved", "replaced", "replacing"}) write(name);
  inChild([&] {
    static Leftover renamed = leftFile(file("renamed"));
    renamed.release();
    { const Leftover owned = leftFile(file("owned")); }
    Leftover from = leftFile(file("moved"));
    static const Leftover to = std::move(from);  // one thing, not two
    static Leftover other = leftFile(file("replaced"));
    other = leftFile(file("replacing"));
  });
  EXPECT_TRUE(exists("renamed"));
  EXPECT_TRUE(exists("owned"));
  EXPECT_FALSE(exists("moved"));
  EXPECT_TRUE(exists("replaced"));
  EXPECT_FALSE(exists("replacing"));
}

// Of two that take over from one another only one stands for the file.
TEST_F(Leftovers, WhatWasMovedStandsForNothing) {
  std::vector<Leftover> two(2);
  two[0] = leftFile(file("a"));
  EXPECT_TRUE(two[0]);
  Leftover third = std::move(two[0]);
  EXPECT_FALSE(two[0]);
  EXPECT_TRUE(third);
  two[1] = std::move(third);
  EXPECT_TRUE(two[1]);
  two[0] = std::move(two[1]);
  EXPECT_FALSE(two[1]);
  EXPECT_TRUE(two[0]);
  two[0].release();
  EXPECT_FALSE(two[0]);
}

// Folders that were made on the way to a result, from the inside out; not those that hold what somebody put there.
TEST_F(Leftovers, FoldersThatAreEmptyThenGoWithWhatIsInThem) {
  std::filesystem::create_directories(file("a/b"));
  std::filesystem::create_directories(file("c"));
  write("a/b/draft");
  write("c/mine");
  inChild([&] {
    static const Leftover a = Leftover::emptyFolder(file("a")), b = Leftover::emptyFolder(file("a/b"));
    static const Leftover draft = leftFile(file("a/b/draft"));
    static const Leftover c = Leftover::emptyFolder(file("c"));
  });
  EXPECT_FALSE(exists("a"));
  EXPECT_TRUE(exists("c/mine"));
}

TEST_F(Leftovers, ANameIsThatOfTheFolderInWhichItWasGiven) {
  write("a");
  inChild([&] {
    if (chdir(folder_.path().c_str()) != 0) return;
    static const Leftover a = leftFile("a");
    if (chdir("/") != 0) return;
  });
  EXPECT_FALSE(exists("a"));
}

// The grandchild holds the writing end of a pipe, which is closed only when it has ended.
TEST_F(Leftovers, ProcessesAreKilled) {
  int ends[2];
  ASSERT_EQ(pipe(ends), 0);
  inChild([&] {
    static const Leftover process = Leftover::process([] {
      const pid_t grandchild = fork();
      if (grandchild == 0) {
        for (;;) pause();
      }
      return grandchild;
    });
  });
  close(ends[1]);
  char byte = 0;
  EXPECT_EQ(read(ends[0], &byte, 1), 0);
  close(ends[0]);
}

TEST_F(Leftovers, WhatWasNotMadeIsNone) {
  EXPECT_FALSE(Leftover::file([] { return std::filesystem::path(); }));
  EXPECT_FALSE(Leftover::process([] { return pid_t{-1}; }));
  EXPECT_FALSE(Leftover::process([] { return pid_t{0}; }));
  EXPECT_THROW(static_cast<void>(Leftover::folder([]() -> std::filesystem::path { throw 1; })), int);
  write("a");
  EXPECT_TRUE(leftFile(file("a")));  // and the register goes on
}

// Each of these is made by a thread while the process ends. Whatever the moment, it is removed or never there.
TEST_F(Leftovers, NothingNewIsMadeAfterTheEnd) {
  const std::vector<std::function<void()>> makers = {
      [&] { static_cast<void>(Leftover::file([&] { return write("late"), file("late"); })); },
      [&] { const AtomicFile late(file("a.vdb")); },
      [&] { const DraftFolder late(folder_.path(), ".palpate-"); },
      [&] { static_cast<void>(Leftover::process([&] { return write("process"), pid_t{-1}; })); },
  };
  for (const auto& make : makers) {
    inChild([&] {
      endLeftovers();
      std::thread(make).detach();
      std::this_thread::sleep_for(std::chrono::milliseconds(50));
      _exit(0);
    });
    EXPECT_EQ(folder_.files(), 0) << "maker " << &make - makers.data();
  }
}

// The same with the end at a random moment, some of them between the making and the registering of old.
TEST_F(Leftovers, WhatIsMadeWhileTheProcessEndsIsNotLeft) {
  for (int i = 0; i < 60; ++i) {
    inChild([&] {
      std::thread([&] {
        for (;;) {
          const AtomicFile file_of_thread(file("a.vdb"));
          const DraftFolder drafts(folder_.path(), ".palpate-");
        }
      }).detach();
      std::this_thread::sleep_for(std::chrono::microseconds(500 + 37 * i));
    });
    ASSERT_EQ(folder_.files(), 0) << "try " << i;
  }
}

}  // namespace leftover_test
}  // namespace palpate
