// SPDX-License-Identifier: Apache-2.0
// A library to be preloaded into a servo's program: once the process has given up its rights, and waits for an engine,
// this tries from within what it should not be able to do any more, and says of each attempt what the kernel said.
//
// The first sleep after that is the moment: nanosleep(2) is called here. It prints "probe NAME ERRNO" on the standard
// error output; 0: it worked; above 1000: a signal ended the child that tried it. What it needs is in the environment:
// PALPATE_PROBE_SOCKET (somebody listens there), _FILE (of this user), _SHARED (a name of shared memory), _OWN (the
// servo's folder), _LEFT (the number of a descriptor that was open when the program was started).
#include <cerrno>
#include <csignal>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <ctime>
#include <string>

#include <dlfcn.h>
#include <fcntl.h>
#include <sched.h>
#include <sys/file.h>
#include <sys/mman.h>
#include <sys/resource.h>
#include <sys/socket.h>
#include <sys/syscall.h>
#include <sys/un.h>
#include <sys/wait.h>
#include <unistd.h>

namespace {

std::string given(const char* name) {
  const char* const value = std::getenv(("PALPATE_PROBE_" + std::string(name)).c_str());
  return value != nullptr ? value : "";
}

std::string contentsOf(const char* path) {
  std::string text(4096, '\0');
  const int file = open(path, O_RDONLY | O_CLOEXEC);
  const ssize_t got = read(file, text.data(), text.size());
  close(file);
  text.resize(static_cast<size_t>(got > 0 ? got : 0));
  return text;
}

bool isServo() {
  return contentsOf("/proc/self/comm") == "palpate-servo\n" &&
         contentsOf("/proc/thread-self/status").find("\nSeccomp:\t2\n") != std::string::npos;
}

template <class Call>
void attempt(const char* name, const Call& call) {
  errno = 0;
  const int result = call() < 0 ? errno : 0;
  dprintf(STDERR_FILENO, "probe %s %d\n", name, result);
}

// In a child, which inherits all that this process may not do.
template <class Call>
long inChild(const Call& call) {
  const pid_t child = fork();
  if (child == 0) _exit(call() < 0 ? errno : 0);
  int status = 0;
  waitpid(child, &status, 0);
  errno = WIFSIGNALED(status) ? 1000 + WTERMSIG(status) : WEXITSTATUS(status);
  return errno == 0 ? 0 : -1;
}

long opened(const std::string& path, int flags) {
  const int file = open(path.c_str(), flags | O_CLOEXEC, 0600);
  const int why = errno;
  if (file >= 0) close(file);
  errno = why;
  return file;
}

long called() {
  sockaddr_un there = {};
  there.sun_family = AF_UNIX;
  given("SOCKET").copy(there.sun_path, sizeof there.sun_path - 1);
  const int mine = socket(AF_UNIX, SOCK_SEQPACKET | SOCK_CLOEXEC, 0);
  const int result = connect(mine, reinterpret_cast<const sockaddr*>(&there), sizeof there);
  const int why = errno;
  close(mine);
  errno = why;
  return result;
}

long mapped(int file) {
  return mmap(nullptr, 4096, PROT_READ | PROT_EXEC, MAP_PRIVATE, file, 0) == MAP_FAILED ? -1 : 0;
}

long codeInMemory() {
  const int memory = memfd_create("code", MFD_CLOEXEC);
  return memory < 0 || write(memory, "\xC3", 1) != 1 ? 0 : mapped(memory);
}

long codeInAPage() {
  void* const page = mmap(nullptr, 4096, PROT_READ | PROT_WRITE, MAP_PRIVATE | MAP_ANONYMOUS, -1, 0);
  return mprotect(page, 4096, PROT_READ | PROT_EXEC);
}

// Of the C library, and used by nobody. The loader says in words alone that the kernel refused to map it; that there is
// no such file would be said otherwise.
long libraryLoaded() {
  if (dlopen("libBrokenLocale.so.1", RTLD_NOW) != nullptr) return 0;
  const char* const words = dlerror();
  const bool is_refused = words != nullptr && std::strstr(words, "failed to map segment") != nullptr;
  errno = is_refused ? EPERM : ENOENT;
  return -1;
}

// Whether another process opens the file for this one: whoever is at the other end of what is open here is asked.
long openedByTheBroker() {
  const std::string request = "o" + given("FILE");
  for (int socket = 3; socket < 32; ++socket) {
    int type = 0;
    socklen_t size = sizeof type;
    if (getsockopt(socket, SOL_SOCKET, SO_TYPE, &type, &size) != 0 || type != SOCK_SEQPACKET) continue;
    if (send(socket, request.data(), request.size(), MSG_NOSIGNAL) < 0) continue;
    char bytes[4096];
    alignas(cmsghdr) char control[256] = {};
    iovec part = {.iov_base = bytes, .iov_len = sizeof bytes};
    msghdr message = {};
    message.msg_iov = &part;
    message.msg_iovlen = 1;
    message.msg_control = control;
    message.msg_controllen = sizeof control;
    ssize_t got = -1;
    for (int look = 0; look < 1000 && got <= 0; ++look) {  // for 10 s at most
      got = recvmsg(socket, &message, MSG_DONTWAIT);
      if (got <= 0 && errno != EAGAIN) return 0;
      if (got <= 0) usleep(10'000);
    }
    // Refused for what it is, and not for a request that nobody understands.
    const std::string answer(bytes, static_cast<std::size_t>(std::max<ssize_t>(0, got)));
    if (answer.find("it is no device of hidraw") == std::string::npos) return 0;
    for (cmsghdr* head = CMSG_FIRSTHDR(&message); head != nullptr; head = CMSG_NXTHDR(&message, head))
      if (head->cmsg_type == SCM_RIGHTS) return 0;
    errno = EACCES;
    return -1;
  }
  return 0;  // nobody was asked
}

pid_t broker() {
  const std::string children = contentsOf("/proc/thread-self/children");
  return static_cast<pid_t>(std::strtol(children.c_str(), nullptr, 10));
}

void probe() {
  const sched_param same = {.sched_priority = 0};
  const std::string file = given("FILE"), shared = "/dev/shm" + given("SHARED"), fresh = given("OWN") + "/fresh";
  attempt("call", called);
  attempt("call-from-child", [] { return inChild(called); });
  attempt("broker-opens-file", openedByTheBroker);
  attempt("code-in-memory", codeInMemory);
  attempt("code-in-page", codeInAPage);
  attempt("code-in-file", [] { return mapped(open("/proc/self/exe", O_RDONLY | O_CLOEXEC)); });
  attempt("library", libraryLoaded);
  attempt("program", [] { return inChild([] { return execl("/bin/true", "true", nullptr); }); });
  attempt("device-read", [] { return opened("/dev/zero", O_RDONLY); });
  attempt("device-write", [] { return opened("/dev/zero", O_RDWR); });
  attempt("shared-read", [&] { return opened(shared, O_RDONLY); });
  attempt("shared-write", [&] { return opened(shared, O_RDWR); });
  attempt("file-read", [&] { return opened(file, O_RDONLY); });
  attempt("file-empty", [&] { return opened(file, O_RDONLY | O_TRUNC); });
  attempt("file-lock", [&] { return flock(open(file.c_str(), O_RDONLY | O_CLOEXEC), LOCK_EX | LOCK_NB); });
  attempt("socket-folder-lock", [&] {
    const std::string folder = file.substr(0, file.rfind('/'));
    return flock(open(folder.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC), LOCK_EX | LOCK_NB);
  });
  attempt("file-write", [&] { return opened(file, O_WRONLY); });
  attempt("file-make", [&] { return opened(file + ".fresh", O_WRONLY | O_CREAT); });
  attempt("file-remove", [&] { return unlink(file.c_str()); });
  attempt("own-make", [&] { return opened(fresh, O_WRONLY | O_CREAT | O_EXCL); });
  attempt("own-remove", [&] { return unlink(fresh.c_str()); });
  attempt("own-memory", [] { return opened("/proc/self/mem", O_RDWR); });
  attempt("left-open", [] { return fcntl(std::atoi(given("LEFT").c_str()), F_GETFD); });
  attempt("input", [] {
    char place[64] = {};
    const bool is_nothing =
        readlink("/proc/self/fd/0", place, sizeof place - 1) > 0 && !std::strcmp(place, "/dev/null");
    errno = ENODATA;
    return is_nothing ? -1 : 0;
  });
  for (const int output : {STDOUT_FILENO, STDERR_FILENO})
    attempt(output == STDOUT_FILENO ? "output" : "error-output", [output] {
      char byte = 0;
      return read(output, &byte, 1);
    });
  attempt("internet", [] { return socket(AF_INET, SOCK_STREAM, 0); });
  attempt("desktop", [] { return socket(AF_UNIX, SOCK_STREAM, 0); });
  attempt("signal-parent", [] { return kill(getppid(), 0); });
  attempt("signal-broker", [] { return kill(broker(), SIGKILL); });
  attempt("schedule-parent", [&] { return sched_setscheduler(getppid(), SCHED_BATCH, &same); });
  attempt("schedule-broker", [&] { return sched_setscheduler(broker(), SCHED_BATCH, &same); });
  attempt("schedule-itself", [&] { return sched_setscheduler(0, SCHED_OTHER, &same); });
  attempt("limit-parent", [] { return prlimit(getppid(), RLIMIT_CORE, nullptr, nullptr); });
  dprintf(STDERR_FILENO, "probe done 0\n");
}

}  // namespace

extern "C" int nanosleep(const timespec* time, timespec* left) {
  static bool is_done = false;
  if (!is_done && isServo()) {
    is_done = true;
    probe();
  }
  static const auto real = reinterpret_cast<int (*)(const timespec*, timespec*)>(dlsym(RTLD_NEXT, "nanosleep"));
  return real(time, left);
}
