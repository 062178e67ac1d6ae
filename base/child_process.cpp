// SPDX-License-Identifier: Apache-2.0
#include "base/child_process.hpp"

#include <algorithm>
#include <array>
#include <cerrno>
#include <cmath>
#include <csignal>
#include <cstdint>
#include <cstring>
#include <new>
#include <string_view>
#include <system_error>

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include "base/descriptor.hpp"
#include "base/end_with_parent.hpp"

namespace palpate {
namespace {

#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
constexpr bool kSanitized = true;  // the shadow memory is larger than any limit
#else
constexpr bool kSanitized = false;
#endif

constexpr const char* kTooLong = "reading it takes too long";
constexpr const char* kTooMuch = "it asks for more memory than a file of its size can need";

// --- what goes through the pipe: a letter, a length, bytes ----------------------------------------------------------

constexpr char kDone = 'd', kThrewError = 'e', kThrew = 'x', kNoMemory = 'm', kNoDescriptor = 'f';

bool writeAllBytes(int to, std::string_view bytes) {
  while (!bytes.empty()) {
    const ssize_t count = write(to, bytes.data(), bytes.size());
    if (count < 0 && errno == EINTR) continue;
    if (count <= 0) return false;
    bytes.remove_prefix(static_cast<std::size_t>(count));
  }
  return true;
}

bool readAllBytes(int from, char* bytes, std::size_t count) {
  while (count > 0) {
    const ssize_t got = read(from, bytes, count);
    if (got < 0 && errno == EINTR) continue;
    if (got <= 0) return false;
    bytes += got;
    count -= static_cast<std::size_t>(got);
  }
  return true;
}

bool send(int to, char kind, std::string_view bytes) {
  std::array<char, 9> head = {kind};
  const std::uint64_t length = bytes.size();
  std::memcpy(head.data() + 1, &length, sizeof length);
  return writeAllBytes(to, {head.data(), head.size()}) && writeAllBytes(to, bytes);
}

// The parts of an Error, separated by zeros; no part contains a zero.
std::string packed(const Error& error) {
  const char zero = '\0';
  return std::to_string(static_cast<int>(error.code())) + zero + error.input() + zero + error.reason() + zero +
         error.remedy();
}

Error unpacked(std::string_view text) {
  std::array<std::string, 4> parts;
  for (std::string& part : parts) {
    part = text.substr(0, text.find('\0'));
    text.remove_prefix(std::min(text.size(), part.size() + 1));
  }
  return {static_cast<Error::Code>(std::stoi(parts[0])), parts[1], parts[2], parts[3]};
}

// --- the child ------------------------------------------------------------------------------------------------------

void isolateChild(pid_t parent) {
  endWithParent(parent, SIGKILL);
  for (const int signal : {SIGINT, SIGTERM, SIGHUP, SIGQUIT, SIGPIPE, SIGXCPU, SIGALRM, SIGSEGV, SIGABRT, SIGBUS}) {
    std::signal(signal, SIG_DFL);
  }
  sigset_t none;
  sigemptyset(&none);
  sigprocmask(SIG_SETMASK, &none, nullptr);
  const rlimit no_core = {0, 0};
  setrlimit(RLIMIT_CORE, &no_core);
  const int sink = open("/dev/null", O_WRONLY);
  dup2(sink, STDOUT_FILENO);
  dup2(sink, STDERR_FILENO);
  if (sink > STDERR_FILENO) close(sink);
}

// 0, or the errno for which a library could not open its files. The library would report a damaged file.
int descriptorShortage(int any) {
  std::array<int, 8> spare;  // more than a library has open at a time
  int shortage = 0;
  for (int& one : spare) {
    one = shortage == 0 ? dup(any) : -1;
    if (one < 0 && shortage == 0) shortage = errno;
  }
  for (const int one : spare) {
    if (one >= 0) close(one);
  }
  return shortage;
}

// The address space that this process has now [byte]; the first number of statm is in pages.
std::uint64_t addressSpaceBytes() {
  std::array<char, 64> text = {};
  const int file = open("/proc/self/statm", O_RDONLY | O_CLOEXEC);
  if (file < 0) return 0;
  const ssize_t got = read(file, text.data(), text.size() - 1);
  close(file);
  if (got <= 0) return 0;
  return std::strtoull(text.data(), nullptr, 10) * static_cast<std::uint64_t>(sysconf(_SC_PAGESIZE));
}

void limitMemory(std::size_t more_bytes) {
  const std::uint64_t now = addressSpaceBytes();
  if (kSanitized || now == 0) return;
  rlimit limit = {};
  getrlimit(RLIMIT_AS, &limit);
  limit.rlim_cur = std::min<rlim_t>(limit.rlim_max, now + more_bytes);
  setrlimit(RLIMIT_AS, &limit);
}

double cpuSeconds() {
  rusage used = {};
  getrusage(RUSAGE_SELF, &used);
  const auto seconds = [](const timeval& time) {
    return static_cast<double>(time.tv_sec) + static_cast<double>(time.tv_usec) * 1e-6;
  };
  return seconds(used.ru_utime) + seconds(used.ru_stime);
}

// The limit is processor time, so a busy machine refuses nothing. Work that waits for ever uses no processor time: an
// alarm ends it after ten times the limit of wall time.
void limitTime(double cpu_s) {
  rlimit limit = {};
  getrlimit(RLIMIT_CPU, &limit);
  limit.rlim_cur = std::min<rlim_t>(limit.rlim_max, static_cast<rlim_t>(std::ceil(cpuSeconds() + cpu_s)));
  setrlimit(RLIMIT_CPU, &limit);
  alarm(static_cast<unsigned>(std::ceil(10 * cpu_s)));
}

// False: the piece failed, or the parent no longer reads. Throws std::bad_alloc if an Error's text does not fit into
// memory.
bool doPiece(int to, const std::function<std::string(std::size_t)>& work, std::size_t n) {
  try {
    return send(to, kDone, work(n));
  } catch (const Error& error) {
    send(to, kThrewError, packed(error));
  } catch (const std::bad_alloc&) {
    send(to, kNoMemory, {});
  } catch (const std::length_error&) {  // a vector longer than the address space
    send(to, kNoMemory, {});
  } catch (const std::exception& failure) {
    send(to, kThrew, failure.what());
  } catch (...) {
    send(to, kThrew, "unknown fault");
  }
  return false;
}

// Never returns or throws: an exception that left it would unwind the caller's frames in this second process.
[[noreturn]] void runChild(pid_t parent, int to, std::size_t count, const ChildLimits& limits,
                           const std::function<std::string(std::size_t)>& work) noexcept {
  isolateChild(parent);
  limitMemory(limits.memory_bytes);
  try {
    if (const int shortage = descriptorShortage(to); shortage != 0) {
      send(to, kNoDescriptor, std::to_string(shortage));
      count = 0;
    }
    for (std::size_t n = 0; n < count; ++n) {
      limitTime(limits.cpu_s);
      if (!doPiece(to, work, n)) break;
    }
  } catch (...) {
    send(to, kNoMemory, {});
  }
  _exit(0);  // no destructor, no exit handler: the process is not ours to tidy
}

// --- the parent -----------------------------------------------------------------------------------------------------

ChildTrouble troubleOf(char kind, const std::string& bytes) {
  using Kind = ChildTrouble::Kind;
  if (kind == kThrewError) return {Kind::kError, unpacked(bytes), ""};
  if (kind == kNoMemory) return {Kind::kMemory, {}, kTooMuch};
  return {Kind::kException, {}, bytes};
}

ChildTrouble troubleOfEnd(int status, const std::string& input) {
  using Kind = ChildTrouble::Kind;
  if (!WIFSIGNALED(status)) return {Kind::kDied, {}, "reading it ends the process"};
  switch (const int signal = WTERMSIG(status)) {
    case SIGXCPU:
    case SIGALRM:
      return {Kind::kTooLong, {}, kTooLong};
    case SIGINT:
    case SIGTERM:
    case SIGHUP:
      throw Error(Error::Code::kCancelled, input, "reading was ended by a signal", "run it again");
    case SIGKILL:
      return {Kind::kMemory, {}, "reading it was killed, as the system does where memory runs out"};
    default:
      return {Kind::kDied, {}, fmt::format("reading it ends in a crash ({})", strsignal(signal))};
  }
}

[[noreturn]] void refuseProcess(const std::string& input, int why) {
  throw Error(Error::Code::kIo, input,
              fmt::format("no process can be started to read it in ({})", std::generic_category().message(why)),
              why == EMFILE || why == ENFILE ? kFreeDescriptors : kFreeProcesses);
}

// Kills and awaits the child on every way out, so that no zombie is left.
class Child {
 public:
  explicit Child(pid_t id) : id_(id) {}
  ~Child() {
    if (id_ <= 0) return;
    kill(id_, SIGKILL);
    static_cast<void>(wait());
  }
  Child(const Child&) = delete;
  Child& operator=(const Child&) = delete;
  int wait() {
    int status = 0;
    while (waitpid(id_, &status, 0) < 0 && errno == EINTR) {
    }
    id_ = -1;
    return status;
  }

 private:
  pid_t id_;
};

// Reads what the child sends, until the pipe ends.
void receive(int from, const std::string& input, std::size_t count, ChildOutcome& outcome) {
  while (outcome.results.size() < count && !outcome.trouble) {
    std::array<char, 9> head;
    std::uint64_t length = 0;
    if (!readAllBytes(from, head.data(), head.size())) return;
    std::memcpy(&length, head.data() + 1, sizeof length);
    std::string bytes(length, '\0');
    if (!readAllBytes(from, bytes.data(), bytes.size())) return;
    if (head[0] == kNoDescriptor) refuseProcess(input, std::stoi(bytes));
    if (head[0] == kDone) {
      outcome.results.push_back(std::move(bytes));
    } else {
      outcome.trouble = troubleOf(head[0], bytes);
    }
  }
}

}  // namespace

ChildLimits limitsForFile(double file_bytes, double more_bytes) {
  constexpr double kBytesPerSecond = 4.0 * (1 << 20);
  ChildLimits limits;
  limits.memory_bytes += static_cast<std::size_t>(2 * file_bytes + more_bytes);
  limits.cpu_s += std::floor(file_bytes / kBytesPerSecond);
  return limits;
}

ChildOutcome runInChild(const std::string& input, std::size_t count, const ChildLimits& limits,
                        const std::function<std::string(std::size_t)>& work) {
  std::array<int, 2> ends = {-1, -1};
  if (pipe2(ends.data(), O_CLOEXEC) != 0) refuseProcess(input, errno);
  Descriptor from(ends[0]), to(ends[1]);
  const pid_t parent = getpid(), id = fork();
  if (id < 0) refuseProcess(input, errno);
  if (id == 0) {
    from.close();
    runChild(parent, to.get(), count, limits, work);
  }
  Child child(id);
  to.close();
  ChildOutcome outcome;
  receive(from.get(), input, count, outcome);
  from.close();
  const int status = child.wait();
  if (!outcome.trouble && outcome.results.size() < count) outcome.trouble = troubleOfEnd(status, input);
  return outcome;
}

}  // namespace palpate
