// SPDX-License-Identifier: Apache-2.0
#include "service/sandbox/call_lists.hpp"

namespace palpate {
namespace {

// clang-format off
constexpr const char* kAllowed[] = {
    // memory
    "brk", "munmap", "mremap", "madvise", "mincore", "msync", "mlock", "mlock2", "munlock", "mlockall", "munlockall",
    "membarrier", "memfd_create", "ftruncate",
    // threads, their priority, signals within the process
    "set_robust_list", "get_robust_list", "rseq", "set_tid_address", "arch_prctl", "gettid", "getpid", "getppid",
    "sched_yield", "sched_getscheduler", "sched_getparam", "sched_get_priority_max", "sched_get_priority_min",
    "sched_getaffinity", "getcpu",
    "rt_sigaction", "rt_sigprocmask", "rt_sigreturn", "rt_sigpending", "rt_sigsuspend", "rt_sigtimedwait", "sigaltstack",
    "restart_syscall", "exit", "exit_group",
    // a child that reads a mesh (base/child_process.hpp) and its limits
    "wait4", "waitid", "alarm", "setitimer", "getitimer", "setrlimit", "getrlimit", "getrusage",
    // clocks
    "clock_nanosleep", "nanosleep", "clock_gettime", "clock_getres", "gettimeofday", "time", "times",
    "timerfd_create", "timerfd_settime", "timerfd_gettime",
    // what is open
    "read", "readv", "pread64", "preadv", "write", "writev", "pwrite64", "pwritev", "lseek", "close", "close_range",
    "dup", "dup2", "dup3", "pipe", "pipe2", "eventfd2", "poll", "ppoll", "select", "pselect6", "epoll_create1",
    "epoll_ctl", "epoll_wait", "epoll_pwait", "fadvise64", "fstat",
    // files, as the fence of files has it (file_fence.hpp)
    "unlink", "unlinkat", "rename", "renameat", "renameat2", "fsync", "fdatasync",
    // looking for devices, modules and meshes
    "stat", "lstat", "newfstatat", "statx", "statfs", "fstatfs", "access", "faccessat", "faccessat2", "readlink",
    "readlinkat", "getdents64", "getcwd", "name_to_handle_at",
    // sockets, once there is one; nobody is called up (service/broker)
    "bind", "listen", "shutdown", "getsockname", "getpeername", "getsockopt", "setsockopt", "sendmsg", "sendmmsg",
    "recvfrom", "recvmsg", "recvmmsg",
    // who and where it is
    "getuid", "geteuid", "getgid", "getegid", "getresuid", "getresgid", "getgroups", "getpgrp", "getpgid", "getsid",
    "getpriority", "capget", "uname", "sysinfo", "getrandom",
};

constexpr const char* kDeadly[] = {
    "execve", "execveat",
    "ptrace", "process_vm_readv", "process_vm_writev", "process_madvise", "pidfd_getfd", "kcmp",
    "bpf", "perf_event_open", "userfaultfd", "io_uring_setup", "io_uring_enter", "io_uring_register",
    "mount", "umount2", "pivot_root", "chroot", "unshare", "setns", "open_tree", "move_mount", "fsopen", "fsconfig",
    "fsmount", "fspick", "mount_setattr", "open_by_handle_at",
    "init_module", "finit_module", "delete_module", "kexec_load", "kexec_file_load", "reboot", "swapon", "swapoff",
    "add_key", "request_key", "keyctl", "iopl", "ioperm", "modify_ldt",
};
// clang-format on

}  // namespace

std::span<const char* const> allowedCalls() noexcept {
  return kAllowed;
}

std::span<const char* const> deadlyCalls() noexcept {
  return kDeadly;
}

}  // namespace palpate
