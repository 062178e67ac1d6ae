// SPDX-License-Identifier: Apache-2.0
// All that a servo gives up together: what is tried in a process that has done so, and what is said of it.
#include "service/sandbox/servo_sandbox.hpp"

#include <algorithm>
#include <cerrno>
#include <csignal>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <functional>
#include <sstream>
#include <thread>

#include <dlfcn.h>
#include <fcntl.h>
#include <gmock/gmock.h>
#include <sched.h>
#include <sys/mman.h>
#include <sys/mount.h>
#include <sys/prctl.h>
#include <sys/resource.h>
#include <sys/socket.h>
#include <sys/stat.h>
#include <sys/syscall.h>
#include <sys/un.h>

#include "base/atomic_file.hpp"
#include "in_child.hpp"
#include "service/sandbox/call_filter.hpp"
#include "service/sandbox/file_fence.hpp"
#include "tests/support/without_call.hpp"

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

// What is handed to it (service/broker): an engine's end, and a device that is open.
TEST_F(Sandbox, UsesWhatIsHandedToIt) {
  int ends[2] = {-1, -1};
  ASSERT_EQ(socketpair(AF_UNIX, SOCK_SEQPACKET | SOCK_CLOEXEC, 0, ends), 0);
  EXPECT_EQ(within([&] { return send(ends[0], "words", 5, MSG_NOSIGNAL); }), 0);
  const int device = open("/dev/zero", O_RDWR | O_CLOEXEC);
  char byte = 0;
  EXPECT_EQ(within([&] { return read(device, &byte, 1); }), 0);
  EXPECT_EQ(within([&] { return write(device, &byte, 1); }), 0);
  for (const int one : {ends[0], ends[1], device}) close(one);
  EXPECT_EQ(within([&] { return open(file("words").c_str(), O_RDONLY); }), 0);
  EXPECT_EQ(within([] { return open("/proc/self/statm", O_RDONLY); }), 0);
  EXPECT_EQ(within([] { return open("/sys/class", O_RDONLY | O_DIRECTORY); }), 0);
  EXPECT_EQ(within([] { return std::filesystem::read_symlink("/proc/self/exe").empty() ? -1 : 0; }), 0);
}

// At a path and at a name of the kernel's.
TEST_F(Sandbox, CallsNobodyUp) {
  const int listener = socket(AF_UNIX, SOCK_SEQPACKET | SOCK_CLOEXEC, 0);
  sockaddr_un address = {};
  address.sun_family = AF_UNIX;
  std::snprintf(address.sun_path, sizeof address.sun_path, "%s", file("socket").c_str());
  const auto* const there = reinterpret_cast<const sockaddr*>(&address);
  ASSERT_EQ(bind(listener, there, sizeof address), 0);
  ASSERT_EQ(listen(listener, 4), 0);
  const auto call = [&] { return connect(socket(AF_UNIX, SOCK_SEQPACKET, 0), there, sizeof address); };
  EXPECT_EQ(resultInChild([&] { return errnoOf(call); }), 0);
  EXPECT_EQ(within(call), EPERM);
  EXPECT_EQ(within([&] {
              const pid_t child = fork();
              if (child == 0) _exit(errnoOf(call));
              int status = 0;
              waitpid(child, &status, 0);
              errno = WEXITSTATUS(status);
              return errno == 0 ? 0 : -1;
            }),
            EPERM);
  close(listener);
}

// The two holes through which there were others: memory with a name, and a file that could be written before.
TEST_F(Sandbox, RunsNoMachineCodeThatWasNotThere) {
#if defined(__x86_64__)
  constexpr unsigned char kReturn7[] = {0xB8, 0x07, 0x00, 0x00, 0x00, 0xC3};  // mov eax, 7; ret
  const auto made = [&](int protection) -> long {
    const int memory = memfd_create("code", MFD_CLOEXEC);
    if (write(memory, kReturn7, sizeof kReturn7) != sizeof kReturn7) return 0;
    void* const code = mmap(nullptr, 4096, protection, MAP_PRIVATE, memory, 0);
    if (code == MAP_FAILED) return -1;
    return reinterpret_cast<int (*)()>(code)() == 7 ? 0 : -1;
  };
  ASSERT_EQ(resultInChild([&] { return errnoOf([&] { return made(PROT_READ | PROT_EXEC); }); }), 0);
  EXPECT_EQ(within([&] { return made(PROT_READ | PROT_EXEC); }), EPERM);
#endif
  EXPECT_EQ(within([&] {
              const int page = open(file("words").c_str(), O_RDONLY);
              return mmap(nullptr, 4096, PROT_READ | PROT_EXEC, MAP_PRIVATE, page, 0) == MAP_FAILED ? -1 : 0;
            }),
            EPERM);
}

// Those that were loaded before are still there; another one is refused.
TEST_F(Sandbox, LoadsNoLibraries) {
  constexpr const char* kAnother = "libBrokenLocale.so.1";  // the C library has it, and nobody uses it
  const auto loads = [&](int more = 0) { return dlopen(kAnother, RTLD_NOW | RTLD_LOCAL | more) != nullptr; };
  ASSERT_FALSE(loads(RTLD_NOLOAD));
  ASSERT_EQ(resultInChild([&] { return loads() ? 0 : 1; }), 0);
  EXPECT_EQ(resultInChild([&] {
              static_cast<void>(enterServoSandbox());
              return loads() ? 0 : 1;
            }),
            1);
  EXPECT_EQ(resultInChild([&] {
              if (!loads()) return 2;
              static_cast<void>(enterServoSandbox());
              return loads() ? 0 : 1;
            }),
            0);
}

// Of /dev it has what its children's words go to; other programs' shared memory, terminals and other devices not even
// to read.
TEST_F(Sandbox, HasNoOtherDevices) {
  EXPECT_EQ(within([] { return open("/dev/null", O_RDWR); }), 0);
  for (const char* device : {"/dev/zero", "/dev/full", "/dev/tty", "/dev/ptmx", "/dev/urandom"}) {
    if (access(device, F_OK) != 0) continue;
    EXPECT_EQ(within([&] { return open(device, O_RDWR); }), EACCES) << device;
    EXPECT_EQ(within([&] { return open(device, O_RDONLY); }), EACCES) << device;
  }
  EXPECT_EQ(within([] { return open("/dev", O_RDONLY | O_DIRECTORY); }), EACCES);
}

TEST_F(Sandbox, HasNoOthersSharedMemory) {
  const std::string name = "/palpate-sandbox-" + std::to_string(getpid());
  const int memory = shm_open(name.c_str(), O_RDWR | O_CREAT | O_EXCL, 0600);
  if (memory < 0 && access("/dev/shm", F_OK) != 0) GTEST_SKIP() << "this machine has no /dev/shm";
  ASSERT_GE(memory, 0) << std::strerror(errno);
  close(memory);
  EXPECT_EQ(within([&] { return shm_open(name.c_str(), O_RDWR, 0600); }), EACCES);
  EXPECT_EQ(within([&] { return shm_open(name.c_str(), O_RDONLY, 0600); }), EACCES);
  EXPECT_EQ(within([&] { return shm_open((name + "-fresh").c_str(), O_RDWR | O_CREAT, 0600); }), EACCES);
  EXPECT_EQ(within([&] { return shm_unlink(name.c_str()); }), EACCES);
  shm_unlink(name.c_str());
}

// A machine without USB gets its folder in a view of the files that only this process has.
bool hasUsbFolder() {
  if (access("/dev/bus/usb", F_OK) == 0) return true;
  return unshare(geteuid() == 0 ? CLONE_NEWNS : CLONE_NEWNS | CLONE_NEWUSER) == 0 &&
         mount(nullptr, "/", nullptr, MS_REC | MS_PRIVATE, nullptr) == 0 &&
         mount("none", "/dev", "tmpfs", 0, nullptr) == 0 && mkdir("/dev/bus", 0755) == 0 &&
         mkdir("/dev/bus/usb", 0755) == 0;
}

// USB devices lie in a folder of their own, also those that are plugged in later.
TEST_F(Sandbox, HasTheUsbDevices) {
  constexpr int kNoFolder = 255;
  const int result = resultInChild([] {
    if (!hasUsbFolder()) return kNoFolder;
    static_cast<void>(enterServoSandbox());
    const int usb = errnoOf([] { return open("/dev/bus/usb", O_RDONLY | O_DIRECTORY); });
    const int all = errnoOf([] { return open("/dev/bus", O_RDONLY | O_DIRECTORY); });
    return usb == 0 && all == EACCES ? 0 : 1;
  });
  if (result == kNoFolder) GTEST_SKIP() << "this machine has no USB, and no namespaces to pretend that it has";
  EXPECT_EQ(result, 0);
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

// As device_stamp.hpp (apps/devices) does it: whole or not at all, which elsewhere takes a lock. Also over an older
// one.
TEST_F(Sandbox, WritesWholeNotesInItsOwnFolder) {
  for (const char* words : {"first", "second"}) {
    const auto write = [&] {
      static_cast<void>(enterServoSandbox(std::filesystem::path(file("note")).parent_path().string()));
      writeFileAtomically(file("note"), words);
      return 0;
    };
    EXPECT_EQ(resultInChild(write), 0);
    std::string note;
    std::getline(std::ifstream(file("note")), note);
    EXPECT_EQ(note, words);
  }
}

// Read or not, and in its own folder, whatever the kernel's Landlock knows.
TEST_F(Sandbox, EmptiesNothingByOpening) {
  EXPECT_EQ(within([&] { return open(file("words").c_str(), O_RDONLY | O_TRUNC); }), EPERM);
  EXPECT_EQ(std::filesystem::file_size(file("words")), 5U);
}

TEST_F(Sandbox, LeavesOthersAlone) {
  EXPECT_EQ(within([] { return kill(getppid(), 0); }), EPERM);
  EXPECT_EQ(within([] { return open(("/proc/" + std::to_string(getppid()) + "/mem").c_str(), O_RDONLY); }), EACCES);
  EXPECT_EQ(within([] { return socket(AF_INET, SOCK_STREAM, 0); }), EPERM);
  EXPECT_EQ(within([] { return execl("/bin/true", "true", nullptr); }), -SIGSYS);
}

// Neither real time nor processors nor niceness of another process, which this user could change otherwise.
TEST_F(Sandbox, SchedulesItselfAlone) {
  const sched_param same = {.sched_priority = 0};
  const auto batch = [&](pid_t whom) { return sched_setscheduler(whom, SCHED_BATCH, &same); };
  const pid_t other = fork();
  if (other == 0) {
    pause();
    _exit(0);
  }
  ASSERT_EQ(resultInChild([&] { return errnoOf([&] { return batch(other); }); }), 0);  // it could
  EXPECT_EQ(within([&] { return batch(other); }), EPERM);
  EXPECT_EQ(within([&] {
              cpu_set_t one = {};
              CPU_SET(0, &one);
              return sched_setaffinity(other, sizeof one, &one);
            }),
            EPERM);
  EXPECT_EQ(within([&] { return setpriority(PRIO_PROCESS, static_cast<id_t>(other), 5); }), EPERM);
  EXPECT_EQ(within([&] { return batch(0); }), 0);
  kill(other, SIGKILL);
  waitpid(other, nullptr, 0);
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

TEST(SandboxWords, NameWhatASystemLacks) {
  using testing::ElementsAre;
  const FileFence old = {.stands = true}, whole = {.stands = true, .holds_signals = true, .holds_emptying = true};
  const FileFence none = {.why_not = "this kernel has no Landlock: take Linux 5.13 or newer"};
  EXPECT_TRUE(missingOf(whole, "").empty());
  EXPECT_TRUE(missingOf(old, "").empty()) << "the filter holds what this Landlock does not";
  EXPECT_THAT(missingOf(whole, "why"), ElementsAre("all system calls (why)"));
  EXPECT_THAT(missingOf(old, "why"),
              ElementsAre("emptying files (this kernel's Landlock is too old for it: take Linux 6.2 or newer)",
                          "all system calls (why)"));
  EXPECT_THAT(missingOf(none, ""),
              ElementsAre("all of /dev and writing files (this kernel has no Landlock: take Linux 5.13 or newer)"));
}

// What to do is said where it helps: no newer kernel makes a folder that is not there.
TEST_F(Sandbox, TheRemedyFitsTheReason) {
  EXPECT_EQ(resultInChild([] {
              if (!loseCall(SYS_landlock_create_ruleset, EOPNOTSUPP)) return 2;
              const std::string words = wordsOf(enterServoSandbox());
              return words.find(
                         "all of /dev and writing files (Landlock is switched off in this kernel: add it to "
                         "lsm=") != words.npos &&
                             words.find("5.13") == words.npos
                         ? 0
                         : 1;
            }),
            0);
  EXPECT_EQ(resultInChild([] {
              const std::string words = wordsOf(enterServoSandbox("/there/is/none"));
              return words.find("(No such file or directory)") != words.npos ? 0 : 1;
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
