// SPDX-License-Identifier: Apache-2.0
// What a process in the sandbox can do, and what it cannot: each is tried in a child of its own.
#include "service/sandbox/sandbox.hpp"

#include <cerrno>
#include <csignal>
#include <fstream>
#include <functional>
#include <thread>

#include <arpa/inet.h>
#include <dlfcn.h>
#include <fcntl.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <linux/capability.h>
#include <linux/netlink.h>
#include <sched.h>
#include <sys/mman.h>
#include <sys/mount.h>
#include <sys/prctl.h>
#include <sys/ptrace.h>
#include <sys/socket.h>
#include <sys/stat.h>
#include <sys/syscall.h>
#include <sys/wait.h>
#include <unistd.h>

#include "base/atomic_file.hpp"
#include "service/channel/channel.hpp"
#include "service/memory/link_memory.hpp"
#include "tests/apps/report/temporary_folder.hpp"

namespace palpate {
namespace sandbox_test {

using testing::HasSubstr;

constexpr int kNoFilter = 99, kNoLandlock = 98;  // exit statuses: nothing to test on this system

// Its exit status, or 256 and the signal that ended it.
int inSandbox(const std::function<int()>& work, const std::vector<std::filesystem::path>& kept = {}) {
  const pid_t child = fork();
  if (child == 0) {
    const Sandbox sandbox = enterSandbox(kept);
    _exit(sandbox.filters_calls ? work() : kNoFilter);
  }
  int status = 0;
  waitpid(child, &status, 0);
  return WIFSIGNALED(status) ? 256 + WTERMSIG(status) : WEXITSTATUS(status);
}

// What a call came to: 0, or its errno.
int errnoOf(long result) {
  return result < 0 ? errno : 0;
}

class SandboxTest : public testing::Test {
 protected:
  void SetUp() override {
    if (inSandbox([] { return 0; }) == kNoFilter) GTEST_SKIP() << "system calls cannot be filtered here";
  }
  [[nodiscard]] std::string file(const std::string& name) const { return (folder_.path() / name).string(); }
  TemporaryFolder folder_;
};

TEST_F(SandboxTest, WhatOnlyAnAttackerWouldTryIsDeadly) {
  const auto isDeadly = [](const char* what, const std::function<long()>& call) {
    EXPECT_EQ(inSandbox([&] { return errnoOf(call()); }), 256 + SIGSYS) << what;
  };
  isDeadly("execve", [] {
    char* const words[] = {nullptr};
    return static_cast<long>(execve("/bin/true", words, words));
  });
  isDeadly("ptrace", [] { return ptrace(PTRACE_ATTACH, getppid(), nullptr, nullptr); });
  isDeadly("mount", [] { return static_cast<long>(mount("none", "/tmp", "tmpfs", 0, nullptr)); });
  isDeadly("unshare", [] { return static_cast<long>(unshare(CLONE_NEWUSER)); });
  isDeadly("bpf", [] { return syscall(SYS_bpf, 0, nullptr, 0); });
  isDeadly("process_vm_writev", [] { return syscall(SYS_process_vm_writev, getppid(), nullptr, 0, nullptr, 0, 0); });
  isDeadly("io_uring", [] { return syscall(SYS_io_uring_setup, 1, nullptr); });
}

TEST_F(SandboxTest, WhatIsNotNeededFails) {
  const auto fails = [](const char* what, int with, const std::function<long()>& call) {
    EXPECT_EQ(inSandbox([&] { return errnoOf(call()); }), with) << what;
  };
  fails("an internet socket", EPERM, [] { return static_cast<long>(socket(AF_INET, SOCK_STREAM, 0)); });
  fails("a packet socket", EPERM, [] { return static_cast<long>(socket(AF_PACKET, SOCK_RAW, 0)); });
  fails("another user", EPERM, [] { return static_cast<long>(setuid(1)); });
  fails("other rights", EPERM, [] { return static_cast<long>(chmod("/tmp", 0777)); });
  fails("another owner", EPERM, [] { return static_cast<long>(chown("/tmp", 1, 1)); });
  fails("a name in the kernel", EPERM, [] { return static_cast<long>(sethostname("x", 1)); });
  fails("a call that does not exist", EPERM, [] { return syscall(100'000); });
  fails("a new namespace", EPERM,
        [] { return syscall(SYS_clone, CLONE_NEWUSER | SIGCHLD, nullptr, nullptr, nullptr, 0); });
}

// With Landlock: files can be read, and not written, made, renamed or removed.
TEST_F(SandboxTest, FilesCannotBeWritten) {
  std::ofstream(file("there")) << "kept";
  const auto tried = [&](const std::function<long()>& call) {
    return inSandbox([&] {
      const int made = open(file("probe").c_str(), O_CREAT | O_WRONLY | O_CLOEXEC, 0600);
      return made >= 0 ? kNoLandlock : errnoOf(call());
    });
  };
  if (tried([] { return 0L; }) == kNoLandlock) GTEST_SKIP() << "this kernel has no Landlock";
  EXPECT_EQ(tried([&] { return static_cast<long>(open(file("there").c_str(), O_RDONLY | O_CLOEXEC)); }), 0);
  EXPECT_EQ(tried([&] { return static_cast<long>(open(file("there").c_str(), O_WRONLY | O_CLOEXEC)); }), EACCES);
  EXPECT_EQ(tried([&] { return static_cast<long>(open(file("new").c_str(), O_CREAT | O_RDWR | O_CLOEXEC, 0600)); }),
            EACCES);
  EXPECT_NE(tried([&] { return static_cast<long>(unlink(file("there").c_str())); }), 0);
  EXPECT_NE(tried([&] { return static_cast<long>(rename(file("there").c_str(), file("other").c_str())); }), 0);
  EXPECT_NE(tried([&] { return static_cast<long>(mkdir(file("folder").c_str(), 0700)); }), 0);
  EXPECT_NE(tried([&] { return static_cast<long>(symlink("there", file("link").c_str())); }), 0);
  EXPECT_EQ(tried([] { return static_cast<long>(open("/dev/null", O_RDWR | O_CLOEXEC)); }), 0);
  std::ifstream kept(file("there"));
  std::string word;
  EXPECT_TRUE(kept >> word);
  EXPECT_EQ(word, "kept");
}

// A note of a device's calibration is made, replaced and removed there, and only there.
TEST_F(SandboxTest, FilesAreKeptWhereTheCallerSays) {
  const std::filesystem::path notes = folder_.path() / "notes";
  std::filesystem::create_directories(notes);
  std::ofstream(notes / "old") << "old";
  EXPECT_EQ(inSandbox(
                [&] {
                  writeFileAtomically(notes / "new", "new");
                  writeFileAtomically(notes / "new", "newer");
                  return unlink((notes / "old").c_str()) == 0 ? 0 : 1;
                },
                {notes, folder_.path() / "none"}),
            0);
  EXPECT_FALSE(std::filesystem::exists(notes / "old"));
  std::ifstream written(notes / "new");
  std::string word;
  EXPECT_TRUE(written >> word);
  EXPECT_EQ(word, "newer");
  const auto outside = [&] {
    return open(file("probe").c_str(), O_CREAT | O_WRONLY | O_CLOEXEC, 0600) >= 0 ? kNoLandlock : errno;
  };
  EXPECT_EQ(inSandbox(outside, {notes}), inSandbox(outside));
}

// What a servo lives on.
TEST_F(SandboxTest, AServoCanDoItsWork) {
  Listener engine(file("service.sock"));
  EXPECT_EQ(inSandbox([&] {
              Channel channel = connectTo(file("service.sock"));
              const std::byte one{1};
              if (!channel.send({&one, 1}, 1000)) return 1;
              // Memory that was sent, mapped by both.
              LinkMemory ours(4096);
              const LinkMemory theirs(Descriptor(fcntl(ours.descriptor(), F_DUPFD_CLOEXEC, 0)), 4096);
              // Threads, with a priority of their own where the system gives one, and locked memory likewise.
              int slept = -1;
              std::thread servo([&] {
                sched_param priority{.sched_priority = 1};
                static_cast<void>(sched_setscheduler(0, SCHED_FIFO, &priority));
                static_cast<void>(mlockall(MCL_CURRENT));
                const timespec moment{.tv_sec = 0, .tv_nsec = 1000};
                slept = clock_nanosleep(CLOCK_MONOTONIC, 0, &moment, nullptr);
              });
              servo.join();
              if (slept != 0) return 2;
              // A library that is loaded late, and how the kernel tells of devices.
              if (dlopen("libz.so.1", RTLD_NOW) == nullptr) return 3;
              if (socket(AF_NETLINK, SOCK_RAW | SOCK_CLOEXEC, NETLINK_KOBJECT_UEVENT) < 0) return 4;
              // A child that reads a mesh.
              const pid_t child = fork();
              if (child == 0) _exit(7);
              int status = 0;
              if (waitpid(child, &status, 0) != child || WEXITSTATUS(status) != 7) return 5;
              return 0;
            }),
            0);
  Channel met = engine.accept();
  Packet packet;
  EXPECT_EQ(met.receive(packet, 1000), Channel::Got::kPacket);
}

// No right comes back, and of root's none is left but those for real time.
TEST_F(SandboxTest, RightsAreGone) {
  EXPECT_EQ(inSandbox([] {
              if (prctl(PR_GET_NO_NEW_PRIVS, 0, 0, 0, 0) != 1) return 1;
              __user_cap_header_struct head{.version = _LINUX_CAPABILITY_VERSION_3, .pid = 0};
              __user_cap_data_struct sets[_LINUX_CAPABILITY_U32S_3] = {};
              if (syscall(SYS_capget, &head, sets) != 0) return 2;
              const std::uint32_t most = CAP_TO_MASK(CAP_SYS_NICE) | CAP_TO_MASK(CAP_IPC_LOCK);
              if ((sets[0].permitted & ~most) != 0 || sets[1].permitted != 0) return 3;
              if ((sets[0].effective & ~most) != 0 || sets[0].inheritable != 0) return 4;
              for (int capability = 0; capability <= CAP_LAST_CAP; ++capability) {
                const bool kept = capability == CAP_SYS_NICE || capability == CAP_IPC_LOCK;
                if (getuid() == 0 && !kept && prctl(PR_CAPBSET_READ, capability, 0, 0, 0) != 0) return 5;
              }
              return 0;
            }),
            0);
}

// Threads that were there before are in it, too.
TEST_F(SandboxTest, HoldsForEveryThread) {
  const pid_t child = fork();
  if (child == 0) {
    std::atomic<bool> entered{false};
    std::atomic<int> outcome{-1};
    std::thread earlier([&] {
      entered.wait(false);
      outcome = errnoOf(socket(AF_INET, SOCK_STREAM, 0));
    });
    static_cast<void>(enterSandbox({}));
    entered = true;
    entered.notify_all();
    earlier.join();
    _exit(outcome);
  }
  int status = 0;
  waitpid(child, &status, 0);
  EXPECT_EQ(WEXITSTATUS(status), EPERM);
}

TEST(Sandbox, SaysWhatItDid) {
  const auto words = [](const char* asked) {
    int ends[2];
    EXPECT_EQ(pipe(ends), 0);
    if (const pid_t child = fork(); child == 0) {
      if (asked != nullptr) setenv("PALPATE_SANDBOX", asked, 1);
      const Sandbox sandbox = enterSandbox({});
      _exit(write(ends[1], sandbox.words.data(), sandbox.words.size()) > 0 ? 0 : 1);
    }
    close(ends[1]);
    std::string all;
    char part[256];
    for (ssize_t count = 0; (count = read(ends[0], part, sizeof part)) > 0;)
      all.append(part, static_cast<std::size_t>(count));
    close(ends[0]);
    wait(nullptr);
    return all;
  };
  EXPECT_THAT(words("off"), HasSubstr("PALPATE_SANDBOX is off"));
  EXPECT_THAT(words(nullptr), HasSubstr("filtered"));
}

}  // namespace sandbox_test
}  // namespace palpate
