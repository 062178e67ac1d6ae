// SPDX-License-Identifier: Apache-2.0
#include "service/sandbox/call_filter.hpp"

#include <cerrno>
#include <cstdint>
#include <cstring>
#include <initializer_list>
#include <memory>
#include <set>
#include <vector>

#include <fcntl.h>
#include <linux/futex.h>
#include <linux/netlink.h>
#include <linux/seccomp.h>
#include <sched.h>
#include <seccomp.h>
#include <sys/ioctl.h>
#include <sys/mman.h>
#include <sys/prctl.h>
#include <sys/socket.h>
#include <sys/syscall.h>
#include <unistd.h>

#include "service/sandbox/call_lists.hpp"

namespace palpate {
namespace {

#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
constexpr bool kUnderSanitizer = true;
#else
constexpr bool kUnderSanitizer = false;
#endif

// Calls from here on have the same number on every kind of processor; up to kLastCall there is none with another sense.
constexpr int kFirstCommonCall = 424, kLastCall = 480;

constexpr std::uint64_t kNewNamespaces =
    CLONE_NEWNS | CLONE_NEWCGROUP | CLONE_NEWUTS | CLONE_NEWIPC | CLONE_NEWUSER | CLONE_NEWPID | CLONE_NEWNET;
constexpr std::uint64_t kKindOfSocket = 0xF;                                // without SOCK_CLOEXEC and SOCK_NONBLOCK
constexpr std::uint64_t kIoctlType = 0xFF00, kHid = 0x4800, kUsb = 0x5500;  // 'H', 'U'
constexpr int kNameMemory = 0x53564d41;                                     // PR_SET_VMA

// Bits of an argument that must be so.
scmp_arg_cmp bits(unsigned argument, std::uint64_t mask, std::uint64_t value) {
  return {argument, SCMP_CMP_MASKED_EQ, mask, value};
}

// An argument of 32 bits; what is above them in the register is anything.
scmp_arg_cmp is(unsigned argument, long value) {
  return bits(argument, 0xFFFF'FFFFU, static_cast<std::uint32_t>(value));
}

class CallFilter {
 public:
  explicit CallFilter(bool signals_held) : context_(seccomp_init(SCMP_ACT_ERRNO(EPERM)), seccomp_release) {
    if (context_ == nullptr) {
      failure_ = ENOMEM;
      return;
    }
    set(SCMP_FLTATR_ACT_BADARCH, SCMP_ACT_KILL_PROCESS);  // calls of 32-bit programs
    set(SCMP_FLTATR_CTL_TSYNC, 1);                        // all threads
    set(SCMP_FLTATR_API_SYSRAWRC, 1);                     // the kernel's own error
    // None of the rest is a reason to have no filter.
    seccomp_attr_set(context_.get(), SCMP_FLTATR_CTL_LOG, 1);
    seccomp_attr_set(context_.get(), SCMP_FLTATR_CTL_OPTIMIZE, 2);  // a tree, not a list
    // Without this, kernels before 5.16 slow down the whole process against an attack by code that it does not run.
    seccomp_attr_set(context_.get(), SCMP_FLTATR_CTL_SSB, 1);
    for (const char* name : allowedCalls()) allow(name, {});
    for (const char* name : deadlyCalls()) {
      if (!kUnderSanitizer || std::strcmp(name, "ptrace") != 0) add(SCMP_ACT_KILL_PROCESS, name, {});
    }
    allowFiles();
    allowDescriptors();
    allowMemory();
    allowThreads(signals_held);
    allowSockets();
    allowDevices();
    if (kUnderSanitizer)
      for (const char* name : {"ptrace", "prctl", "clone", "personality"}) allow(name, {});
    refuseWhatIsNewer();
  }

  // 0, or an errno value.
  int load() { return failure_ != 0 ? failure_ : -seccomp_load(context_.get()); }

 private:
  void note(int result) {
    if (result != 0 && failure_ == 0) failure_ = -result;
  }
  void set(scmp_filter_attr attribute, std::uint32_t value) {
    note(seccomp_attr_set(context_.get(), attribute, value));
  }
  void add(std::uint32_t action, const char* name, std::initializer_list<scmp_arg_cmp> arguments) {
    const int number = seccomp_syscall_resolve_name(name);
    if (number < 0) return;  // no such call here
    named_.insert(number);
    note(seccomp_rule_add_array(context_.get(), action, number, static_cast<unsigned>(arguments.size()),
                                arguments.begin()));
  }
  // Several for one name: any of them is enough.
  void allow(const char* name, std::initializer_list<scmp_arg_cmp> arguments) { add(SCMP_ACT_ALLOW, name, arguments); }

  // But not to empty one, which Landlock before its version 3 lets whoever may read it do.
  void allowFiles() {
    allow("open", {bits(1, O_TRUNC, 0)});
    allow("openat", {bits(2, O_TRUNC, 0)});
  }

  void allowDescriptors() {
    for (const int command : {F_DUPFD, F_DUPFD_CLOEXEC, F_GETFD, F_SETFD, F_GETFL, F_SETFL, F_GET_SEALS, F_ADD_SEALS})
      allow("fcntl", {is(1, command)});
  }

  // No machine code is made, and none is loaded: not even from a file, which may be memory, or have been written.
  void allowMemory() {
    allow("mmap", {bits(2, PROT_EXEC, 0)});
    allow("mprotect", {bits(2, PROT_EXEC, 0)});
  }

  // By clone(), whose flags can be seen; clone3() has them in memory.
  void allowThreads(bool signals_held) {
    allow("clone", {bits(0, kNewNamespaces, 0)});
    for (const int option : {PR_SET_NAME, PR_GET_NAME, PR_SET_PDEATHSIG, PR_GET_DUMPABLE, PR_CAPBSET_READ, kNameMemory})
      allow("prctl", {is(0, option)});
    for (const char* name : {"prlimit64", "sched_setscheduler", "sched_setparam", "sched_setaffinity"})
      allow(name, {is(0, 0)});  // of whoever calls
    // Without those that lend a waiter's priority to the owner of a lock: that is any process that the word names.
    for (const int command : {FUTEX_WAIT, FUTEX_WAKE, FUTEX_REQUEUE, FUTEX_CMP_REQUEUE, FUTEX_WAKE_OP,
                              FUTEX_WAIT_BITSET, FUTEX_WAKE_BITSET})
      allow("futex", {bits(1, static_cast<std::uint32_t>(FUTEX_CMD_MASK), static_cast<std::uint32_t>(command))});
    for (const char* name : {"kill", "tgkill"}) {
      if (signals_held) {
        allow(name, {});
      } else {
        allow(name, {is(0, getpid())});
      }
    }
  }

  void allowSockets() {
    allow("socket", {is(0, AF_UNIX), bits(1, kKindOfSocket, SOCK_SEQPACKET)});
    allow("socket", {is(0, AF_NETLINK), is(2, NETLINK_KOBJECT_UEVENT)});
    allow("socketpair", {is(0, AF_UNIX), bits(1, kKindOfSocket, SOCK_SEQPACKET)});  // datagrams could go to others
    allow("sendto", {bits(4, ~std::uint64_t{0}, 0)});                               // to whom it is connected
  }

  // Nor to type into the terminal that the servo was started in (TIOCSTI).
  void allowDevices() {
    for (const std::uint64_t type : {kHid, kUsb}) allow("ioctl", {bits(1, kIoctlType, type)});
    for (const long request : {TCGETS, TIOCGWINSZ, FIONREAD, FIONBIO, FIOCLEX}) allow("ioctl", {is(1, request)});
  }

  void refuseWhatIsNewer() {
    for (int number = kFirstCommonCall; number <= kLastCall; ++number) {
      if (!named_.contains(number))
        note(seccomp_rule_add_array(context_.get(), SCMP_ACT_ERRNO(ENOSYS), number, 0, nullptr));
    }
  }

  std::unique_ptr<void, void (*)(scmp_filter_ctx)> context_;
  std::set<int> named_;
  int failure_ = 0;
};

}  // namespace

bool hasCallFilters() noexcept {
  const std::uint32_t action = SECCOMP_RET_ERRNO;
  return syscall(SYS_seccomp, SECCOMP_GET_ACTION_AVAIL, 0, &action) == 0;
}

std::string filterCalls(bool signals_held) {
  if (!hasCallFilters())
    return "the system offers no filters of them, seccomp: allow them where this machine or container is set up";
  const int failure = CallFilter(signals_held).load();
  return failure == 0 ? std::string() : std::strerror(failure);
}

}  // namespace palpate
