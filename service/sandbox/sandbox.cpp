// SPDX-License-Identifier: Apache-2.0
#include "service/sandbox/sandbox.hpp"

#include <cerrno>
#include <cstdlib>
#include <cstring>
#include <memory>
#include <string_view>

#include <fmt/format.h>
#include <linux/capability.h>
#include <sched.h>
#include <seccomp.h>
#include <sys/prctl.h>
#include <sys/socket.h>
#include <sys/syscall.h>
#include <unistd.h>

#include "service/sandbox/write_rights.hpp"

namespace palpate {
namespace {

constexpr bool kHasSanitizer =
#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
    true;
#else
    false;
#endif

constexpr int kKept[] = {CAP_SYS_NICE, CAP_IPC_LOCK};

// What a servo, its device and the libraries under it use.
constexpr int kAllowed[] = {
    // memory
    SCMP_SYS(brk), SCMP_SYS(mmap), SCMP_SYS(munmap), SCMP_SYS(mremap), SCMP_SYS(mprotect), SCMP_SYS(madvise),
    SCMP_SYS(mlock), SCMP_SYS(mlock2), SCMP_SYS(munlock), SCMP_SYS(mlockall), SCMP_SYS(munlockall),
    SCMP_SYS(memfd_create), SCMP_SYS(membarrier), SCMP_SYS(mincore), SCMP_SYS(msync),
    // threads and time
    SCMP_SYS(futex), SCMP_SYS(set_robust_list), SCMP_SYS(get_robust_list), SCMP_SYS(rseq), SCMP_SYS(set_tid_address),
    SCMP_SYS(gettid), SCMP_SYS(getpid), SCMP_SYS(getppid), SCMP_SYS(sched_yield), SCMP_SYS(sched_setscheduler),
    SCMP_SYS(sched_getscheduler), SCMP_SYS(sched_setparam), SCMP_SYS(sched_getparam), SCMP_SYS(sched_setattr),
    SCMP_SYS(sched_getattr), SCMP_SYS(sched_get_priority_max), SCMP_SYS(sched_get_priority_min),
    SCMP_SYS(sched_setaffinity), SCMP_SYS(sched_getaffinity), SCMP_SYS(setpriority), SCMP_SYS(getpriority),
    SCMP_SYS(getcpu), SCMP_SYS(nanosleep), SCMP_SYS(clock_nanosleep), SCMP_SYS(clock_gettime), SCMP_SYS(clock_getres),
    SCMP_SYS(gettimeofday), SCMP_SYS(time), SCMP_SYS(timerfd_create), SCMP_SYS(timerfd_settime),
    SCMP_SYS(timerfd_gettime), SCMP_SYS(arch_prctl), SCMP_SYS(prctl),
    // files, of which Landlock says which may be written
    SCMP_SYS(read), SCMP_SYS(readv), SCMP_SYS(pread64), SCMP_SYS(write), SCMP_SYS(writev), SCMP_SYS(pwrite64),
    SCMP_SYS(lseek), SCMP_SYS(open), SCMP_SYS(openat), SCMP_SYS(close), SCMP_SYS(close_range), SCMP_SYS(fstat),
    SCMP_SYS(stat), SCMP_SYS(lstat), SCMP_SYS(newfstatat), SCMP_SYS(statx), SCMP_SYS(statfs), SCMP_SYS(fstatfs),
    SCMP_SYS(access), SCMP_SYS(faccessat), SCMP_SYS(faccessat2), SCMP_SYS(readlink), SCMP_SYS(readlinkat),
    SCMP_SYS(getdents64), SCMP_SYS(getcwd), SCMP_SYS(fcntl), SCMP_SYS(flock), SCMP_SYS(ftruncate), SCMP_SYS(fadvise64),
    SCMP_SYS(fsync), SCMP_SYS(fdatasync), SCMP_SYS(dup), SCMP_SYS(dup2), SCMP_SYS(dup3), SCMP_SYS(pipe),
    SCMP_SYS(pipe2), SCMP_SYS(ioctl), SCMP_SYS(umask), SCMP_SYS(rename), SCMP_SYS(renameat), SCMP_SYS(renameat2),
    SCMP_SYS(link), SCMP_SYS(linkat), SCMP_SYS(unlink), SCMP_SYS(unlinkat), SCMP_SYS(fchmod), SCMP_SYS(fallocate),
    // waiting
    SCMP_SYS(poll), SCMP_SYS(ppoll), SCMP_SYS(select), SCMP_SYS(pselect6), SCMP_SYS(epoll_create1), SCMP_SYS(epoll_ctl),
    SCMP_SYS(epoll_wait), SCMP_SYS(epoll_pwait), SCMP_SYS(eventfd2), SCMP_SYS(inotify_init1),
    SCMP_SYS(inotify_add_watch), SCMP_SYS(inotify_rm_watch),
    // sockets, of the kinds below
    SCMP_SYS(connect), SCMP_SYS(bind), SCMP_SYS(listen), SCMP_SYS(accept4), SCMP_SYS(sendmsg), SCMP_SYS(recvmsg),
    SCMP_SYS(sendto), SCMP_SYS(recvfrom), SCMP_SYS(getsockopt), SCMP_SYS(setsockopt), SCMP_SYS(getsockname),
    SCMP_SYS(getpeername), SCMP_SYS(shutdown),
    // signals, ends, and a child that reads a mesh (base/child_process.hpp)
    SCMP_SYS(rt_sigaction), SCMP_SYS(rt_sigprocmask), SCMP_SYS(rt_sigreturn), SCMP_SYS(rt_sigtimedwait),
    SCMP_SYS(sigaltstack), SCMP_SYS(tgkill), SCMP_SYS(kill), SCMP_SYS(restart_syscall), SCMP_SYS(exit),
    SCMP_SYS(exit_group), SCMP_SYS(wait4), SCMP_SYS(waitid), SCMP_SYS(fork), SCMP_SYS(vfork), SCMP_SYS(setpgid),
    // what it is told of itself and of the machine
    SCMP_SYS(getuid), SCMP_SYS(geteuid), SCMP_SYS(getgid), SCMP_SYS(getegid), SCMP_SYS(getrlimit), SCMP_SYS(setrlimit),
    SCMP_SYS(prlimit64), SCMP_SYS(getrusage), SCMP_SYS(uname), SCMP_SYS(sysinfo), SCMP_SYS(getrandom),
    SCMP_SYS(capget)};

// What only an attacker would try here.
constexpr int kDeadly[] = {SCMP_SYS(execve),
                           SCMP_SYS(execveat),
                           SCMP_SYS(ptrace),
                           SCMP_SYS(process_vm_readv),
                           SCMP_SYS(process_vm_writev),
                           SCMP_SYS(bpf),
                           SCMP_SYS(perf_event_open),
                           SCMP_SYS(userfaultfd),
                           SCMP_SYS(kexec_load),
                           SCMP_SYS(kexec_file_load),
                           SCMP_SYS(init_module),
                           SCMP_SYS(finit_module),
                           SCMP_SYS(delete_module),
                           SCMP_SYS(mount),
                           SCMP_SYS(umount2),
                           SCMP_SYS(pivot_root),
                           SCMP_SYS(move_mount),
                           SCMP_SYS(fsopen),
                           SCMP_SYS(open_tree),
                           SCMP_SYS(setns),
                           SCMP_SYS(unshare),
                           SCMP_SYS(chroot),
                           SCMP_SYS(reboot),
                           SCMP_SYS(swapon),
                           SCMP_SYS(settimeofday),
                           SCMP_SYS(clock_settime),
                           SCMP_SYS(add_key),
                           SCMP_SYS(keyctl),
                           SCMP_SYS(io_uring_setup),
                           SCMP_SYS(open_by_handle_at)};

constexpr scmp_datum_t kNamespaces =
    CLONE_NEWNS | CLONE_NEWCGROUP | CLONE_NEWUTS | CLONE_NEWIPC | CLONE_NEWUSER | CLONE_NEWPID | CLONE_NEWNET;

// A negative errno value, or 0.
int addRules(scmp_filter_ctx filter) noexcept {
  int failed = 0;
  // A call that this machine does not have is no failure.
  const auto rule = [&](std::uint32_t action, int call, unsigned count = 0, scmp_arg_cmp when = {}) {
    const int result = seccomp_rule_add_array(filter, action, call, count, count > 0 ? &when : nullptr);
    if (result < 0 && result != -EDOM && result != -EFAULT) failed = result;
  };
  for (const int call : kAllowed) rule(SCMP_ACT_ALLOW, call);
  for (const int call : kDeadly) rule(SCMP_ACT_KILL_PROCESS, call);
  for (const int family : {AF_UNIX, AF_NETLINK}) {
    rule(SCMP_ACT_ALLOW, SCMP_SYS(socket), 1, SCMP_A0(SCMP_CMP_EQ, static_cast<scmp_datum_t>(family)));
  }
  rule(SCMP_ACT_ALLOW, SCMP_SYS(socketpair), 1, SCMP_A0(SCMP_CMP_EQ, AF_UNIX));
  rule(SCMP_ACT_ALLOW, SCMP_SYS(clone), 1, SCMP_A0(SCMP_CMP_MASKED_EQ, kNamespaces, 0));
  rule(SCMP_ACT_ERRNO(ENOSYS), SCMP_SYS(clone3));  // its flags cannot be seen; the C library takes clone then
  return failed;
}

int filterCalls() noexcept {
  const std::unique_ptr<void, void (*)(scmp_filter_ctx)> filter(seccomp_init(SCMP_ACT_ERRNO(EPERM)), seccomp_release);
  if (!filter) return -ENOMEM;
  int failed = seccomp_attr_set(filter.get(), SCMP_FLTATR_CTL_TSYNC, 1);
  if (failed == 0) failed = addRules(filter.get());
  if (failed == 0) static_cast<void>(seccomp_attr_set(filter.get(), SCMP_FLTATR_CTL_OPTIMIZE, 2));  // a tree
  return failed == 0 ? seccomp_load(filter.get()) : failed;
}

bool isKept(int capability) noexcept {
  for (const int kept : kKept)
    if (kept == capability) return true;
  return false;
}

// The bounding set first, which needs a right that goes then.
void dropCapabilities() noexcept {
  for (int capability = 0; capability <= CAP_LAST_CAP; ++capability)
    if (!isKept(capability)) prctl(PR_CAPBSET_DROP, capability, 0, 0, 0);
  prctl(PR_CAP_AMBIENT, PR_CAP_AMBIENT_CLEAR_ALL, 0, 0, 0);
  __user_cap_header_struct head{.version = _LINUX_CAPABILITY_VERSION_3, .pid = 0};
  __user_cap_data_struct sets[_LINUX_CAPABILITY_U32S_3] = {};
  if (syscall(SYS_capget, &head, sets) != 0) return;
  __user_cap_data_struct kept[_LINUX_CAPABILITY_U32S_3] = {};
  for (const int capability : kKept) {
    const std::uint32_t bit = CAP_TO_MASK(capability) & sets[CAP_TO_INDEX(capability)].permitted;
    kept[CAP_TO_INDEX(capability)].permitted |= bit;
    kept[CAP_TO_INDEX(capability)].effective |= bit;
  }
  syscall(SYS_capset, &head, kept);
}

}  // namespace

Sandbox enterSandbox(std::span<const std::filesystem::path> kept) noexcept {
  Sandbox sandbox;
  const char* const asked = std::getenv("PALPATE_SANDBOX");
  if (asked != nullptr && std::string_view(asked) == "off") {
    sandbox.words = "PALPATE_SANDBOX is off: no rights are given up, and system calls are not filtered";
    return sandbox;
  }
  dropCapabilities();
  if (kHasSanitizer) {
    sandbox.words = "built with a sanitizer, which needs other system calls: they are not filtered";
    return sandbox;
  }
  if (prctl(PR_SET_NO_NEW_PRIVS, 1, 0, 0, 0) != 0) {
    sandbox.words =
        fmt::format("system calls are not filtered ({}): this system allows no filter", std::strerror(errno));
    return sandbox;
  }
  const std::filesystem::path written[] = {"/dev", "/proc/self"};
  sandbox.limits_files = giveUpWriting(written, kept);
  const int failed = filterCalls();
  sandbox.filters_calls = failed == 0;
  const char* const files = sandbox.limits_files ? "no other files are written than devices and its own notes"
                                                 : "this kernel has no Landlock, so files can be written";
  sandbox.words = failed == 0 ? fmt::format("system calls are filtered; {}", files)
                              : fmt::format("system calls are not filtered ({}); {}", std::strerror(-failed), files);
  return sandbox;
}

}  // namespace palpate
