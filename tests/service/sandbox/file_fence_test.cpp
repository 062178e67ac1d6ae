// SPDX-License-Identifier: Apache-2.0
// Behind the fence files are read, and written in one folder alone. Truth: what the calls themselves say.
#include "service/sandbox/file_fence.hpp"

#include <cerrno>
#include <csignal>
#include <cstddef>
#include <cstdlib>
#include <filesystem>
#include <fstream>

#include <arpa/inet.h>
#include <fcntl.h>
#include <gmock/gmock.h>
#include <poll.h>
#include <sys/prctl.h>
#include <sys/socket.h>
#include <sys/stat.h>
#include <sys/syscall.h>
#include <sys/un.h>

#include "in_child.hpp"

namespace palpate {
namespace file_fence_test {

constexpr int kKnowsTruncate = 3, kKnowsTcp = 4, kKnowsScopes = 6;  // versions of Landlock

// The other tests here are skipped where it says that there is none.
TEST(Landlock, IsThereWhereTheKernelHasIt) {
  const long none = syscall(SYS_landlock_create_ruleset, nullptr, 0, 0);  // refused for its content, if it is known
  ASSERT_LT(none, 0);
  EXPECT_EQ(landlockVersion() > 0, errno != ENOSYS && errno != EOPNOTSUPP);
}

class FenceOfFiles : public testing::Test {
 protected:
  FenceOfFiles() {
    std::string name = (std::filesystem::temp_directory_path() / "palpate-fence-XXXXXX").string();
    root_ = mkdtemp(name.data());
    for (const auto& folder : {inside(), devices(), hidden() / "other"}) std::filesystem::create_directories(folder);
    for (const auto& folder : {root_, inside(), devices(), hidden(), hidden() / "other"})
      std::ofstream(folder / "file") << "words";
    std::filesystem::create_symlink("nowhere", root_ / "link");
    one_ = hidden() / "one";
    std::ofstream(one_) << "words";
  }
  ~FenceOfFiles() override { std::filesystem::remove_all(root_); }
  void SetUp() override {
    if (landlockVersion() == 0) GTEST_SKIP() << "this kernel has no Landlock";
  }

  [[nodiscard]] std::filesystem::path inside() const { return root_ / "inside"; }
  // As /dev: of all that is in it a folder and a file are devices of the servo's.
  [[nodiscard]] std::filesystem::path hidden() const { return root_ / "hidden"; }
  [[nodiscard]] std::filesystem::path devices() const { return hidden() / "devices"; }
  [[nodiscard]] std::string hiddenFile() const { return (hidden() / "file").string(); }
  [[nodiscard]] std::string file() const { return (root_ / "file").string(); }
  [[nodiscard]] std::string insideFile() const { return (inside() / "file").string(); }
  // errno after the call behind the fence; 0: it works.
  [[nodiscard]] int behind(const std::function<long()>& call) const {
    return resultInChild([&] {
      prctl(PR_SET_NO_NEW_PRIVS, 1, 0, 0, 0);
      // Only beside what is hidden can anything be read, and the fence begins in its folder.
      const FencedPlaces places = {
          .hidden = hidden().string(), .devices = {devices().string(), one_.string()}, .own = inside().string()};
      return fenceFiles(places).stands ? errnoOf(call) : 255;
    });
  }

 private:
  std::filesystem::path root_, one_;
};

TEST_F(FenceOfFiles, ReadsBesideWhatIsHidden) {
  EXPECT_EQ(behind([&] { return open(file().c_str(), O_RDONLY); }), 0);
  EXPECT_EQ(behind([&] { return open(insideFile().c_str(), O_RDONLY); }), 0);
  EXPECT_EQ(behind([&] { return open(inside().c_str(), O_RDONLY | O_DIRECTORY); }), 0);
}

TEST_F(FenceOfFiles, WhatIsHiddenIsNotReadOrWritten) {
  for (const std::string& path : {hiddenFile(), (hidden() / "other/file").string()}) {
    EXPECT_EQ(behind([&] { return open(path.c_str(), O_RDONLY); }), EACCES);
    EXPECT_EQ(behind([&] { return open(path.c_str(), O_RDWR); }), EACCES);
  }
  EXPECT_EQ(behind([&] { return open(hidden().c_str(), O_RDONLY | O_DIRECTORY); }), EACCES);
  EXPECT_EQ(behind([&] { return open((hidden() / "one").c_str(), O_RDWR); }), 0);
  EXPECT_EQ(behind([&] { return open((devices() / "file").c_str(), O_RDONLY); }), 0);
}

// A link beside it that leads to it, into it, or to all that it lies in. Another one is as good as what it leads to.
TEST_F(FenceOfFiles, WhatIsHiddenIsNotReadByAnotherName) {
  const std::filesystem::path beside = hidden().parent_path();
  std::filesystem::create_symlink(hidden(), beside / "same");
  std::filesystem::create_symlink(hidden() / "other", beside / "within");
  std::filesystem::create_symlink(beside, beside / "around");
  std::filesystem::create_symlink("/", beside / "all");
  std::filesystem::create_symlink(inside(), beside / "good");
  for (const std::string& path : {hiddenFile(), (hidden() / "other/file").string(), (beside / "same/file").string(),
                                  (beside / "within/file").string()})
    EXPECT_EQ(behind([&] { return open(path.c_str(), O_RDONLY); }), EACCES) << path;
  EXPECT_EQ(behind([&] { return open((beside / "good/file").c_str(), O_RDONLY); }), 0);
  EXPECT_EQ(behind([&] { return open(file().c_str(), O_RDONLY); }), 0);
}

TEST_F(FenceOfFiles, SaysWhetherFilesCanBeEmptied) {
  EXPECT_EQ(resultInChild([&] {
              prctl(PR_SET_NO_NEW_PRIVS, 1, 0, 0, 0);
              const FileFence fence = fenceFiles({.hidden = hidden().string()});
              if (!fence.stands) return 255;
              const bool is_emptied = open(file().c_str(), O_RDONLY | O_TRUNC) >= 0;
              return is_emptied != fence.holds_emptying ? 0 : 1;
            }),
            0);
}

TEST_F(FenceOfFiles, WritesInTheFoldersAlone) {
  EXPECT_EQ(behind([&] { return open((devices() / "file").c_str(), O_RDWR); }), 0);
  EXPECT_EQ(behind([&] { return open(insideFile().c_str(), O_RDWR); }), 0);
  EXPECT_EQ(behind([&] { return open(file().c_str(), O_RDWR); }), EACCES);
  EXPECT_EQ(behind([&] { return open(file().c_str(), O_WRONLY | O_APPEND); }), EACCES);
  if (landlockVersion() >= kKnowsTruncate) {
    EXPECT_EQ(behind([&] { return truncate(file().c_str(), 0); }), EACCES);
  }
  EXPECT_EQ(std::filesystem::file_size(file()), 5U);
}

TEST_F(FenceOfFiles, MakesAndRemovesPlainFilesInItsOwnFolder) {
  const std::string old = insideFile(), fresh = (inside() / "fresh").string();
  EXPECT_EQ(behind([&] { return open(fresh.c_str(), O_WRONLY | O_CREAT | O_EXCL, 0600); }), 0);
  EXPECT_EQ(behind([&] { return rename(fresh.c_str(), old.c_str()); }), 0);
  EXPECT_EQ(behind([&] { return open(old.c_str(), O_WRONLY | O_TRUNC); }), 0);
  EXPECT_EQ(behind([&] { return unlink(old.c_str()); }), 0);
  EXPECT_EQ(behind([&] { return mkdir(fresh.c_str(), 0700); }), EACCES);
  EXPECT_EQ(behind([&] { return symlink("there", fresh.c_str()); }), EACCES);
}

TEST_F(FenceOfFiles, MakesRemovesAndRunsNothingElsewhere) {
  for (const std::filesystem::path& folder : {devices(), hidden(), inside().parent_path()}) {
    const std::string old = (folder / "file").string(), fresh = (folder / "fresh").string();
    EXPECT_EQ(behind([&] { return open(fresh.c_str(), O_WRONLY | O_CREAT, 0600); }), EACCES);
    EXPECT_EQ(behind([&] { return mkdir(fresh.c_str(), 0700); }), EACCES);
    EXPECT_EQ(behind([&] { return symlink("there", fresh.c_str()); }), EACCES);
    EXPECT_EQ(behind([&] { return unlink(old.c_str()); }), EACCES);
    EXPECT_EQ(behind([&] { return rename(old.c_str(), fresh.c_str()); }), EACCES);
  }
  EXPECT_EQ(behind([] { return execl("/bin/true", "true", nullptr); }), EACCES);
}

TEST_F(FenceOfFiles, SignalsReachNobodyElse) {
  if (landlockVersion() < kKnowsScopes) GTEST_SKIP() << "this kernel's Landlock does not hold signals";
  EXPECT_EQ(behind([] { return kill(getppid(), 0); }), EPERM);
  EXPECT_EQ(behind([] { return kill(getpid(), 0); }), 0);
  EXPECT_EQ(behind([] {
              const pid_t child = fork();
              if (child == 0) {
                poll(nullptr, 0, 5000);
                _exit(0);
              }
              const int result = kill(child, SIGKILL);
              waitpid(child, nullptr, 0);
              return result;
            }),
            0);
}

// A name of the kernel's, at which somebody listens who is not behind the fence.
TEST_F(FenceOfFiles, CallsNobodyUpWhoHasNoFile) {
  if (landlockVersion() < kKnowsScopes) GTEST_SKIP() << "this kernel's Landlock does not hold abstract sockets";
  sockaddr_un there = {};
  there.sun_family = AF_UNIX;
  const std::string name = "palpate-fence-" + std::to_string(getpid());
  name.copy(there.sun_path + 1, sizeof there.sun_path - 1);
  const auto size = static_cast<socklen_t>(offsetof(sockaddr_un, sun_path) + 1 + name.size());
  const auto* const address = reinterpret_cast<const sockaddr*>(&there);
  const int listener = socket(AF_UNIX, SOCK_SEQPACKET | SOCK_CLOEXEC, 0);
  ASSERT_EQ(bind(listener, address, size), 0);
  ASSERT_EQ(listen(listener, 1), 0);
  const auto call = [&] { return connect(socket(AF_UNIX, SOCK_SEQPACKET, 0), address, size); };
  EXPECT_EQ(resultInChild([&] { return errnoOf(call); }), 0);
  EXPECT_EQ(behind(call), EPERM);
  close(listener);
}

TEST_F(FenceOfFiles, HasNoTcp) {
  if (landlockVersion() < kKnowsTcp) GTEST_SKIP() << "this kernel's Landlock does not know TCP";
  sockaddr_in here = {};
  here.sin_family = AF_INET;
  here.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
  here.sin_port = htons(1);
  const auto* const address = reinterpret_cast<const sockaddr*>(&here);
  const auto made = [] { return socket(AF_INET, SOCK_STREAM, 0); };
  EXPECT_EQ(behind([&] { return connect(made(), address, sizeof here); }), EACCES);
  EXPECT_EQ(behind([&] { return bind(made(), address, sizeof here); }), EACCES);
}

// Without the promise to gain no rights the kernel makes no fence for a user; for root it does.
TEST_F(FenceOfFiles, SaysWhyThereIsNone) {
  EXPECT_EQ(resultInChild([] {
              prctl(PR_SET_NO_NEW_PRIVS, 1, 0, 0, 0);
              const FileFence fence = fenceFiles({.hidden = "/there/is/no/such/folder"});
              return !fence.stands && !fence.holds_signals && !fence.why_not.empty() ? 0 : 1;
            }),
            0);
}

}  // namespace file_fence_test
}  // namespace palpate
