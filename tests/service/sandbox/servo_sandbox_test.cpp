// SPDX-License-Identifier: Apache-2.0
// All that a servo gives up together: what is tried in a process that has done so, and what is said of it.
#include "service/sandbox/servo_sandbox.hpp"

#include <algorithm>
#include <csignal>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <functional>
#include <sstream>
#include <thread>

#include <dlfcn.h>
#include <fcntl.h>
#include <gmock/gmock.h>
#include <sys/prctl.h>
#include <sys/resource.h>
#include <sys/socket.h>
#include <sys/un.h>

#include "in_child.hpp"
#include "service/sandbox/call_filter.hpp"
#include "service/sandbox/file_fence.hpp"

namespace palpate {
namespace servo_sandbox_test {

class Sandbox : public testing::Test {
 protected:
  Sandbox() {
    std::string name = (std::filesystem::temp_directory_path() / "palpate-sandbox-XXXXXX").string();
    folder_ = mkdtemp(name.data());
    std::ofstream(file("words")) << "words";
  }
  ~Sandbox() override { std::filesystem::remove_all(folder_); }
  void SetUp() override {
    if (!hasCallFilters()) GTEST_SKIP() << "this kernel has no seccomp";
    if (landlockVersion() == 0) GTEST_SKIP() << "this kernel has no Landlock";
  }
  [[nodiscard]] std::string file(const std::string& name) const { return (folder_ / name).string(); }

 private:
  std::filesystem::path folder_;
};

int within(const std::function<long()>& call) {
  return resultInChild([&] {
    static_cast<void>(enterServoSandbox());
    return errnoOf(call);
  });
}

TEST_F(Sandbox, IsOneWithAnEngineAndItsDevice) {
  const int listener = socket(AF_UNIX, SOCK_SEQPACKET | SOCK_CLOEXEC, 0);
  sockaddr_un address = {};
  address.sun_family = AF_UNIX;
  std::snprintf(address.sun_path, sizeof address.sun_path, "%s", file("socket").c_str());
  const auto* const there = reinterpret_cast<const sockaddr*>(&address);
  ASSERT_EQ(bind(listener, there, sizeof address), 0);
  ASSERT_EQ(listen(listener, 4), 0);
  EXPECT_EQ(within([&] { return connect(socket(AF_UNIX, SOCK_SEQPACKET, 0), there, sizeof address); }), 0);
  close(listener);
  EXPECT_EQ(within([] { return open("/dev/null", O_RDWR); }), 0);
  EXPECT_EQ(within([&] { return open(file("words").c_str(), O_RDONLY); }), 0);
  EXPECT_EQ(within([] { return open("/proc/self/statm", O_RDONLY); }), 0);
  EXPECT_EQ(within([] { return std::filesystem::read_symlink("/proc/self/exe").empty() ? -1 : 0; }), 0);
}

// As a module is, when a scene first needs it.
TEST_F(Sandbox, LoadsLibraries) {
  EXPECT_EQ(within([] { return dlopen("libresolv.so.2", RTLD_NOW | RTLD_LOCAL) != nullptr ? 0 : -1; }), 0);
}

TEST_F(Sandbox, WritesNothingElse) {
  EXPECT_EQ(within([&] { return open(file("words").c_str(), O_RDWR); }), EACCES);
  EXPECT_EQ(within([&] { return open(file("words").c_str(), O_WRONLY | O_APPEND); }), EACCES);
  EXPECT_EQ(within([&] { return open(file("fresh").c_str(), O_WRONLY | O_CREAT, 0600); }), EACCES);
  EXPECT_EQ(within([&] { return unlink(file("words").c_str()); }), EACCES);
  EXPECT_EQ(within([] { return open("/dev/palpate-fresh", O_RDWR | O_CREAT, 0600); }), EACCES);
  EXPECT_EQ(within([] { return open("/proc/self/comm", O_RDWR); }), EACCES);
}

// As the note that a device is calibrated, which must be taken back as well.
TEST_F(Sandbox, WritesInItsOwnFolder) {
  const auto own = [&](const std::function<long()>& call) {
    return resultInChild([&] {
      static_cast<void>(enterServoSandbox(std::filesystem::path(file("words")).parent_path().string()));
      return errnoOf(call);
    });
  };
  EXPECT_EQ(own([&] { return open(file("fresh").c_str(), O_WRONLY | O_CREAT | O_EXCL, 0600); }), 0);
  EXPECT_EQ(own([&] { return rename(file("fresh").c_str(), file("other").c_str()); }), 0);
  EXPECT_EQ(own([&] { return unlink(file("other").c_str()); }), 0);
  EXPECT_EQ(own([] { return open("/tmp/palpate-fresh", O_WRONLY | O_CREAT, 0600); }), EACCES);
}

TEST_F(Sandbox, LeavesOthersAlone) {
  EXPECT_EQ(within([] { return kill(getppid(), 0); }), EPERM);
  EXPECT_EQ(within([] { return open(("/proc/" + std::to_string(getppid()) + "/mem").c_str(), O_RDONLY); }), EACCES);
  EXPECT_EQ(within([] { return socket(AF_INET, SOCK_STREAM, 0); }), EPERM);
  EXPECT_EQ(within([] { return execl("/bin/true", "true", nullptr); }), -SIGSYS);
}

// The kernel's own account of a process and of a thread that it starts.
TEST_F(Sandbox, IsInTheKernelsAccount) {
  EXPECT_EQ(
      within([] {
        std::string words;
        std::jthread([&] {
          std::ostringstream text;
          text << std::ifstream("/proc/thread-self/status").rdbuf();
          words = text.str();
        }).join();
        const auto says = [&](const char* line) { return words.find(line) != words.npos; };
        return says("\nNoNewPrivs:\t1\n") && says("\nSeccomp:\t2\n") && says("\nCapInh:\t0000000000000000\n") ? 0 : -1;
      }),
      0);
  EXPECT_EQ(within([] {
              rlimit image = {1, 1};
              getrlimit(RLIMIT_CORE, &image);
              return prctl(PR_GET_DUMPABLE, 0, 0, 0, 0) == 0 && image.rlim_max == 0 ? 0 : -1;
            }),
            0);
}

TEST_F(Sandbox, NothingIsMissing) {
  EXPECT_EQ(resultInChild([] { return static_cast<int>(enterServoSandbox().missing.size()); }), 0);
}

TEST_F(Sandbox, WhatTheSystemRefusesIsNamed) {
  EXPECT_EQ(resultInChild([] {
              static_cast<void>(enterServoSandbox());
              const std::string words = wordsOf(enterServoSandbox());  // the filter refuses to make another
              return words.find("all system calls (the system offers no filters") != words.npos ? 0 : 1;
            }),
            0);
}

TEST(SandboxWords, AreOneLine) {
  const SandboxReport all = {.given_up = {"new privileges", "capabilities"}, .missing = {}, .kept = {}};
  EXPECT_EQ(wordsOf(all), "it has given up new privileges, capabilities");
  const SandboxReport some = {
      .given_up = {"new privileges"}, .missing = {"system calls"}, .kept = {"cap_sys_nice (why)"}, .is_root = true};
  EXPECT_EQ(wordsOf(some),
            "it has given up new privileges; it keeps system calls, and cap_sys_nice (why), and the user root (start "
            "it as whoever sits "
            "at the machine)");
  EXPECT_EQ(wordsOf({}), "it has given up nothing");
}

}  // namespace servo_sandbox_test
}  // namespace palpate
