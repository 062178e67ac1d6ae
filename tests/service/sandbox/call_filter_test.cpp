// SPDX-License-Identifier: Apache-2.0
// Behind the filter a servo's calls work, others fail with EPERM, and what nobody calls by mistake kills. Truth: what
// the calls themselves say, tried one by one, each in a process of its own.
#include "service/sandbox/call_filter.hpp"

#include <atomic>
#include <csignal>
#include <cstring>
#include <fstream>
#include <string>
#include <thread>
#include <vector>

#include <fcntl.h>
#include <gmock/gmock.h>
#include <linux/futex.h>
#include <linux/netlink.h>
#include <poll.h>
#include <sched.h>
#include <sys/eventfd.h>
#include <sys/file.h>
#include <sys/ioctl.h>
#include <sys/mman.h>
#include <sys/mount.h>
#include <sys/personality.h>
#include <sys/prctl.h>
#include <sys/ptrace.h>
#include <sys/resource.h>
#include <sys/shm.h>
#include <sys/socket.h>
#include <sys/stat.h>
#include <sys/syscall.h>
#include <sys/uio.h>
#include <sys/un.h>

#include "in_child.hpp"

namespace palpate {
namespace call_filter_test {

#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
constexpr bool kSanitized = true;
#else
constexpr bool kSanitized = false;
#endif

constexpr int kNoFilter = 255;

int filtered(const std::function<long()>& call, bool signals_held = false) {
  return resultInChild([&] {
    prctl(PR_SET_NO_NEW_PRIVS, 1, 0, 0, 0);
    return filterCalls(signals_held).empty() ? errnoOf(call) : kNoFilter;
  });
}

class FilterOfCalls : public testing::Test {
 protected:
  void SetUp() override {
    if (!hasCallFilters()) GTEST_SKIP() << "this kernel has no seccomp";
  }
};

// The other tests here are skipped where it says that there are none.
TEST(CallFilters, AreThereWhereTheKernelListsThem) {
  std::string actions;
  std::getline(std::ifstream("/proc/sys/kernel/seccomp/actions_avail"), actions);
  EXPECT_EQ(hasCallFilters(), (" " + actions + " ").find(" errno ") != std::string::npos);
}

long mapped(int protection, int flags, int descriptor) {
  return mmap(nullptr, 4096, protection, flags, descriptor, 0) == MAP_FAILED ? -1 : 0;
}

void* freshPage() {
  return mmap(nullptr, 4096, PROT_READ | PROT_WRITE, MAP_PRIVATE | MAP_ANONYMOUS, -1, 0);
}

long setFifo(pid_t process) {
  const sched_param wanted = {.sched_priority = 1};
  return sched_setscheduler(process, SCHED_FIFO, &wanted);
}

TEST_F(FilterOfCalls, LetsAServoDoItsWork) {
  EXPECT_EQ(filtered([] {
              std::atomic<int> sum = 0;
              {
                std::jthread one([&] { sum += 1; }), two([&] { sum += 2; });
              }
              return sum == 3 ? 0 : -1;
            }),
            0);
  EXPECT_EQ(filtered([]() -> long {
              const int memory = memfd_create("memory", MFD_CLOEXEC | MFD_ALLOW_SEALING);
              if (ftruncate(memory, 4096) != 0 || fcntl(memory, F_ADD_SEALS, F_SEAL_SHRINK | F_SEAL_GROW) != 0)
                return -1;
              return fcntl(memory, F_GET_SEALS) < 0 ? -1 : mapped(PROT_READ | PROT_WRITE, MAP_SHARED, memory);
            }),
            0);
  EXPECT_EQ(filtered([] {
              const timespec moment = {.tv_sec = 0, .tv_nsec = 1000};
              return -clock_nanosleep(CLOCK_MONOTONIC, 0, &moment, nullptr);
            }),
            0);
  EXPECT_EQ(filtered([] { return mlockall(MCL_CURRENT | MCL_ONFAULT) == 0 || errno == ENOMEM ? 0 : -1; }), 0);
  EXPECT_EQ(filtered([] { return open("/dev/null", O_RDWR | O_CLOEXEC); }), 0);
  EXPECT_EQ(filtered([] {
              pollfd wait = {.fd = eventfd(1, EFD_CLOEXEC), .events = POLLIN, .revents = 0};
              return poll(&wait, 1, 1000) == 1 ? 0 : -1;
            }),
            0);
  EXPECT_EQ(filtered([] { return socket(AF_UNIX, SOCK_SEQPACKET | SOCK_CLOEXEC | SOCK_NONBLOCK, 0); }), 0);
  EXPECT_EQ(filtered([] { return socket(AF_NETLINK, SOCK_RAW | SOCK_CLOEXEC, NETLINK_KOBJECT_UEVENT); }), 0);
  EXPECT_EQ(filtered([] { return prctl(PR_SET_NAME, "servo", 0, 0, 0); }), 0);
  EXPECT_EQ(filtered([] {
              int ends[2] = {};
              if (socketpair(AF_UNIX, SOCK_SEQPACKET | SOCK_CLOEXEC | SOCK_NONBLOCK, 0, ends) != 0) return ssize_t{-1};
              return send(ends[0], "words", 5, MSG_NOSIGNAL);
            }),
            0);
  // Whether it may have real time is the system's to say, as without the filter.
  EXPECT_EQ(filtered([] { return setFifo(0); }), resultInChild([] { return errnoOf([] { return setFifo(0); }); }));
  EXPECT_EQ(filtered([] {
              const sched_param same = {.sched_priority = 0};
              cpu_set_t all = {};
              return sched_setparam(0, &same) + sched_getaffinity(0, sizeof all, &all) +
                     sched_setaffinity(0, sizeof all, &all);
            }),
            0);
  const rlimit no_image = {0, 0};
  EXPECT_EQ(filtered([&] { return setrlimit(RLIMIT_CORE, &no_image); }), 0);
}

// As a mesh is read: a child that can be limited, awaited, and killed where signals are held otherwise.
TEST_F(FilterOfCalls, LetsItReadInAChild) {
  const auto awaited = [] {
    const pid_t child = fork();
    if (child == 0) _exit(7);
    int status = 0;
    return waitpid(child, &status, 0) == child && WEXITSTATUS(status) == 7 ? 0 : -1;
  };
  EXPECT_EQ(filtered(awaited), 0);
  const auto killed = [] {
    const pid_t child = fork();
    if (child == 0) {
      poll(nullptr, 0, 5000);
      _exit(0);
    }
    const int result = kill(child, SIGKILL);
    const int why = errno;
    int status = 0;
    waitpid(child, &status, 0);
    errno = why;
    return result == 0 && WIFSIGNALED(status) && WTERMSIG(status) == SIGKILL ? 0 : -1;
  };
  EXPECT_EQ(filtered(killed, true), 0);
}

TEST_F(FilterOfCalls, SignalsGoToTheProcessItself) {
  EXPECT_EQ(filtered([] { return kill(getpid(), 0); }), 0);
  EXPECT_EQ(filtered([] { return kill(getppid(), 0); }), EPERM);
  EXPECT_EQ(filtered([] { return syscall(SYS_tgkill, getppid(), getppid(), 0); }), EPERM);
  EXPECT_EQ(filtered([] { return syscall(SYS_tkill, getppid(), 0); }, true), EPERM);
  EXPECT_EQ(filtered([] { return raise(SIGUSR1); }), -SIGUSR1);
}

TEST_F(FilterOfCalls, RefusesWithoutHarm) {
  const std::vector<std::pair<const char*, std::function<long()>>> calls = {
      {"truncate", [] { return truncate("/tmp/palpate-fresh", 0); }},
      {"mkdir", [] { return mkdir("/tmp/palpate-fresh", 0700); }},
      {"symlink", [] { return symlink("there", "/tmp/palpate-fresh"); }},
      {"chmod", [] { return chmod("/tmp/palpate-fresh", 0777); }},
      {"chown", [] { return chown("/tmp/palpate-fresh", 1, 1); }},
      {"link", [] { return link("/tmp/palpate-fresh", "/tmp/palpate-other"); }},
      {"internet", [] { return socket(AF_INET, SOCK_STREAM, 0); }},
      {"internet, datagrams", [] { return socket(AF_INET6, SOCK_DGRAM, 0); }},
      {"a desktop's services", [] { return socket(AF_UNIX, SOCK_STREAM, 0); }},
      {"the system's log", [] { return socket(AF_UNIX, SOCK_DGRAM, 0); }},
      {"routes", [] { return socket(AF_NETLINK, SOCK_RAW, NETLINK_ROUTE); }},
      {"accept", [] { return accept(0, nullptr, nullptr); }},
      {"to call somebody up",
       [] {
         const sockaddr_un there = {.sun_family = AF_UNIX, .sun_path = "/tmp/palpate-fresh"};
         return connect(socket(AF_UNIX, SOCK_SEQPACKET, 0), reinterpret_cast<const sockaddr*>(&there), sizeof there);
       }},
      {"pairs that datagrams leave",
       [] {
         int ends[2] = {};
         return socketpair(AF_UNIX, SOCK_DGRAM, 0, ends);
       }},
      {"pairs that a stream leaves",
       [] {
         int ends[2] = {};
         return socketpair(AF_UNIX, SOCK_STREAM, 0, ends);
       }},
      {"words to an address", [] { return sendto(0, "x", 1, 0, reinterpret_cast<const sockaddr*>("there"), 5); }},
      {"memory to write and run",
       [] { return mapped(PROT_READ | PROT_WRITE | PROT_EXEC, MAP_PRIVATE | MAP_ANONYMOUS, -1); }},
      {"anonymous memory to run", [] { return mapped(PROT_READ | PROT_EXEC, MAP_PRIVATE | MAP_ANONYMOUS, -1); }},
      {"memory of a name to run",
       [] {
         const int memory = memfd_create("memory", MFD_CLOEXEC);
         if (ftruncate(memory, 4096) != 0) return 0L;
         return mapped(PROT_READ | PROT_EXEC, MAP_PRIVATE, memory);
       }},
      {"shared memory to run",
       [] {
         const int memory = memfd_create("memory", MFD_CLOEXEC);
         if (ftruncate(memory, 4096) != 0) return 0L;
         return mapped(PROT_READ | PROT_EXEC, MAP_SHARED, memory);
       }},
      {"a file to run", [] { return mapped(PROT_READ | PROT_EXEC, MAP_PRIVATE, open("/proc/self/exe", O_RDONLY)); }},
      {"memory to run after it was written", [] { return mprotect(freshPage(), 4096, PROT_READ | PROT_EXEC); }},
      {"memory to run after it was written, with a key",
       [] { return syscall(SYS_pkey_mprotect, freshPage(), 4096, PROT_READ | PROT_EXEC, -1); }},
      {"pages of a file in another order", [] { return syscall(SYS_remap_file_pages, freshPage(), 4096, 0, 0, 0); }},
      {"a segment to run", [] { return reinterpret_cast<long>(shmat(0, nullptr, SHM_EXEC)); }},
      {"type into a terminal", [] { return ioctl(0, TIOCSTI, "x"); }},
      {"signals by descriptors", [] { return fcntl(0, F_SETOWN, getppid()); }},
      {"a file emptied by who may read it",
       [] { return syscall(SYS_openat, AT_FDCWD, "/dev/null", O_RDONLY | O_TRUNC); }},
      {"a file emptied by who may write it", [] { return open("/dev/null", O_WRONLY | O_CREAT | O_TRUNC, 0600); }},
#ifdef SYS_open
      {"a file emptied by the old call", [] { return syscall(SYS_open, "/dev/null", O_RDONLY | O_TRUNC); }},
#endif
      {"a lock on a folder", [] { return flock(open("/", O_RDONLY | O_DIRECTORY), LOCK_EX | LOCK_NB); }},
      {"a lock that others may share", [] { return flock(open("/", O_RDONLY | O_DIRECTORY), LOCK_SH | LOCK_NB); }},
      {"a lock on a part of a file",
       [] {
         struct flock part = {.l_type = F_RDLCK, .l_whence = SEEK_SET, .l_start = 0, .l_len = 1, .l_pid = 0};
         return fcntl(open("/proc/self/exe", O_RDONLY), F_SETLK, &part);
       }},
      {"a lease on a file", [] { return fcntl(open("/proc/self/exe", O_RDONLY), F_SETLEASE, F_RDLCK); }},
      {"attributes of scheduling", [] { return syscall(SYS_sched_setattr, 0, nullptr, 0); }},
      {"a lock that lends its priority",
       [] {
         std::uint32_t word = static_cast<std::uint32_t>(getppid());  // whose owner it would be
         return syscall(SYS_futex, &word, FUTEX_LOCK_PI, 0, nullptr, nullptr, 0);
       }},
      {"a lock that lends its priority, of one process",
       [] {
         std::uint32_t word = static_cast<std::uint32_t>(getppid());
         return syscall(SYS_futex, &word, FUTEX_LOCK_PI | FUTEX_PRIVATE_FLAG, 0, nullptr, nullptr, 0);
       }},
      {"a System V segment", [] { return syscall(SYS_shmget, 1, 4096, 0600); }},
  };
  for (const auto& [name, call] : calls) {
    EXPECT_EQ(filtered(call), EPERM) << name;
    EXPECT_EQ(filtered(call, true), EPERM) << name;
  }
  if (!kSanitized) {
    EXPECT_EQ(filtered([] { return personality(READ_IMPLIES_EXEC); }), EPERM);
    EXPECT_EQ(filtered([] { return prctl(PR_SET_DUMPABLE, 1, 0, 0, 0); }), EPERM);
  }
}

// What the system refuses to some users in the same way. Each changes nothing where it works.
TEST_F(FilterOfCalls, RefusesWhatThisUserMayDo) {
  static constexpr sched_param kUsual = {.sched_priority = 0};
  const std::vector<std::pair<const char*, std::function<long()>>> calls = {
      {"a user by its number", [] { return setuid(getuid()); }},
      {"limits of another process", [] { return prlimit(getppid(), RLIMIT_CORE, nullptr, nullptr); }},
      {"scheduling of another", [] { return sched_setscheduler(getppid(), SCHED_OTHER, &kUsual); }},
      {"its own by its number", [] { return sched_setscheduler(getpid(), SCHED_OTHER, &kUsual); }},
      {"another's parameters", [] { return sched_setparam(getppid(), &kUsual); }},
      {"another's processors",
       [] {
         cpu_set_t same = {};
         return sched_getaffinity(0, sizeof same, &same) < 0 ? 0L : sched_setaffinity(getppid(), sizeof same, &same);
       }},
      {"another's niceness",
       [] {
         const auto parent = static_cast<id_t>(getppid());
         return setpriority(PRIO_PROCESS, parent, getpriority(PRIO_PROCESS, 0));
       }},
      {"another's disk priority", [] { return syscall(SYS_ioprio_set, 1, getppid(), 0); }},
      {"a namespace",
       [] {
         const long child = syscall(SYS_clone, CLONE_NEWUSER | SIGCHLD, nullptr, nullptr, nullptr, nullptr);
         if (child == 0) _exit(0);
         return child;
       }},
  };
  std::string not_shown;
  for (const auto& [name, call] : calls) {
    if (kSanitized && std::string_view(name) == "a namespace") continue;
    if (const int without = resultInChild([&] { return errnoOf(call); }); without != 0) {
      not_shown += std::string(not_shown.empty() ? "" : ", ") + name + " (" + std::strerror(without) + ")";
      continue;
    }
    EXPECT_EQ(filtered(call), EPERM) << name;
    EXPECT_EQ(filtered(call, true), EPERM) << name;
  }
  if (!not_shown.empty()) GTEST_SKIP() << "the rest holds; of these the system itself refuses some: " << not_shown;
}

// Libraries then take the older call, whose arguments the filter sees.
TEST_F(FilterOfCalls, WhatIsNewIsNotThere) {
  EXPECT_EQ(filtered([] { return syscall(435, nullptr, 0); }), ENOSYS);                // clone3
  EXPECT_EQ(filtered([] { return syscall(437, 0, "/", nullptr, 0); }), ENOSYS);        // openat2
  EXPECT_EQ(filtered([] { return syscall(452, 0, "/", 0, 0); }), ENOSYS);              // fchmodat2
  EXPECT_EQ(filtered([] { return syscall(424, getppid(), 0, nullptr, 0); }), ENOSYS);  // pidfd_send_signal
}

TEST_F(FilterOfCalls, KillsWhoIsNotItselfAnyMore) {
  int place = 0;
  const iovec here = {.iov_base = &place, .iov_len = sizeof place};
  std::vector<std::pair<const char*, std::function<long()>>> calls = {
      {"execve", [] { return execl("/bin/true", "true", nullptr); }},
      {"execve of nothing", [] { return execl("/there/is/none", "none", nullptr); }},
      {"mount", [] { return mount("none", "/mnt", "tmpfs", 0, nullptr); }},
      {"umount", [] { return umount2("/mnt", 0); }},
      {"process_vm_readv", [&] { return process_vm_readv(getppid(), &here, 1, &here, 1, 0); }},
      {"bpf", [] { return syscall(SYS_bpf, 0, nullptr, 0); }},
      {"perf_event_open", [] { return syscall(SYS_perf_event_open, nullptr, 0, 0, 0, 0); }},
      {"unshare", [] { return unshare(CLONE_NEWUSER); }},
      {"setns", [] { return setns(0, 0); }},
      {"chroot", [] { return chroot("/"); }},
      {"init_module", [] { return syscall(SYS_init_module, nullptr, 0, ""); }},
      {"io_uring", [] { return syscall(425, 1, nullptr); }},
      {"keyctl", [] { return syscall(SYS_keyctl, 0, 0, 0, 0, 0); }},
  };
  if (!kSanitized) calls.emplace_back("ptrace", [] { return ptrace(PTRACE_ATTACH, getppid(), nullptr, nullptr); });
  for (const auto& [name, call] : calls) EXPECT_EQ(filtered(call, true), -SIGSYS) << name;
}

// A child that would run a program is killed; the servo is not.
TEST_F(FilterOfCalls, AChildIsFilteredToo) {
  EXPECT_EQ(filtered([] {
              const pid_t child = fork();
              if (child == 0) {
                execl("/bin/true", "true", nullptr);
                _exit(0);
              }
              int status = 0;
              waitpid(child, &status, 0);
              return WIFSIGNALED(status) && WTERMSIG(status) == SIGSYS ? 0 : -1;
            }),
            0);
}

TEST_F(FilterOfCalls, HoldsForThreadsThatWereThere) {
  EXPECT_EQ(resultInChild([] {
              prctl(PR_SET_NO_NEW_PRIVS, 1, 0, 0, 0);
              std::atomic<bool> stands = false;
              int result = 0;
              std::thread before([&] {
                while (!stands) std::this_thread::yield();
                result = errnoOf([] { return socket(AF_INET, SOCK_STREAM, 0); });
              });
              const std::string why_not = filterCalls(true);
              stands = true;
              before.join();
              return why_not.empty() ? result : kNoFilter;
            }),
            EPERM);
}

// Where the system refuses it, here by a filter that stands already.
TEST_F(FilterOfCalls, SaysWhyThereIsNone) {
  EXPECT_EQ(resultInChild([] {
              prctl(PR_SET_NO_NEW_PRIVS, 1, 0, 0, 0);
              if (!filterCalls(true).empty()) return kNoFilter;
              return !hasCallFilters() && !filterCalls(true).empty() ? 0 : 1;
            }),
            0);
}

}  // namespace call_filter_test
}  // namespace palpate
