// SPDX-License-Identifier: Apache-2.0
#include "apps/console/interrupt.hpp"

#include <atomic>
#include <cerrno>
#include <chrono>
#include <csignal>
#include <ctime>
#include <mutex>
#include <thread>

#include <pthread.h>
#include <semaphore.h>
#include <unistd.h>

#include "apps/console/message.hpp"
#include "base/atomic_file.hpp"
#include "base/error.hpp"
#include "base/leftover.hpp"
#include "base/thread_names.hpp"

namespace palpate {
namespace {

using Clock = std::chrono::steady_clock;

// One request may arrive twice: `timeout` signals its child and then the child's whole group.
constexpr double kSameRequest_s = 0.5;

// Time in which work that checks the flag has ended. A person takes this for "at once".
constexpr std::chrono::milliseconds kPatience{150};
constexpr std::chrono::milliseconds kLook{20};  // how often the thread checks the state after a request

constexpr std::size_t kStackBytes = std::size_t{256} << 10U;  // memory may be locked

std::atomic<int> requests = 0;  // requests that count separately
std::atomic<int> kept_works = 0;
std::atomic<bool> is_watched = false;
std::atomic<bool> is_ending = false;  // main() or the waiting thread is reporting the end
std::atomic<int> final_status = 0;    // as main() knows it
timespec first_request{};             // written and read by the handler only
sem_t request_came;

static_assert(std::atomic<int>::is_always_lock_free, "handlers take no lock");

struct Words {
  std::mutex mutex;
  std::string work = "palpate";
  std::string kept;  // empty: nobody said
};

// Never destroyed, since the thread may use it until the process ends.
Words& words() {
  static auto* const all = new Words;
  return *all;
}

double sinceFirstRequest_s() {
  timespec now{};
  clock_gettime(CLOCK_MONOTONIC, &now);  // allowed in a signal handler
  return static_cast<double>(now.tv_sec - first_request.tv_sec) +
         1e-9 * static_cast<double>(now.tv_nsec - first_request.tv_nsec);
}

void note(int signal) {
  const int old_errno = errno;
  if (requests == 0) {
    clock_gettime(CLOCK_MONOTONIC, &first_request);
    requests = 1;
    sem_post(&request_came);
  } else if (sinceFirstRequest_s() > kSameRequest_s) {
    if (requests == 1 && is_watched) {
      clock_gettime(CLOCK_MONOTONIC, &first_request);
      requests = 2;
    } else {
      std::signal(signal, SIG_DFL);
      std::raise(signal);
    }
  }
  errno = old_errno;
}

Error stopped() {
  const std::lock_guard lock(words().mutex);
  const char* kept = filesWritten() == 0 ? "nothing was written; start it again"
                                         : "the files that it had finished are there; start it again for the rest";
  return {Error::Code::kCancelled, words().work, "stopped by the user",
          words().kept.empty() ? kept : words().kept.c_str()};
}

[[noreturn]] void endProcess() {
  if (is_ending.exchange(true)) {
    endLeftovers();
    _exit(final_status);
  }
  endLeftovers();
  if (isatty(STDERR_FILENO) == 1) writeMessage(stderr, "\r\033[K");  // a line of progress
  tellUser(stopped().what());
  _exit(exitStatus(Error::Code::kCancelled));
}

void* watch(void*) {
  nameThisThread("stop");
  while (sem_wait(&request_came) != 0) {
  }
  for (auto since = Clock::now(); requests < 2; std::this_thread::sleep_for(kLook)) {
    if (kept_works > 0) since = Clock::now();
    if (Clock::now() - since > kPatience) break;
  }
  endProcess();
}

// If no thread can be started, work stops only where it checks the flag.
void startWatch() {
  pthread_attr_t attributes;
  pthread_attr_init(&attributes);
  pthread_attr_setstacksize(&attributes, kStackBytes);
  pthread_t thread{};
  is_watched = pthread_create(&thread, &attributes, watch, nullptr) == 0;
  pthread_attr_destroy(&attributes);
  if (is_watched) pthread_detach(thread);
}

bool isIgnored(int signal) {
  struct sigaction before {};
  return sigaction(signal, nullptr, &before) == 0 && before.sa_handler == SIG_IGN;
}

}  // namespace

void catchInterrupts() {
  words();  // creates them before the thread uses them
  sem_init(&request_came, 0, 0);
  startWatch();
  // SIGINT is ignored in what a script starts in the background, where `kill -INT` is meant all the same.
  for (const int signal : {SIGINT, SIGTERM}) std::signal(signal, note);
  if (!isIgnored(SIGHUP)) std::signal(SIGHUP, note);
  std::signal(SIGXFSZ, SIG_IGN);
  std::signal(SIGPIPE, SIG_IGN);
}

void nameWork(const std::string& work) {
  const std::lock_guard lock(words().mutex);
  words().work = work;
}

bool interrupted() noexcept {
  return requests > 0;
}

void throwIfInterrupted(const std::string& work, const std::string& kept) {
  if (interrupted()) throw Error(Error::Code::kCancelled, work, "stopped by the user", kept);
}

KeptWork::KeptWork() noexcept {
  ++kept_works;
}
KeptWork::~KeptWork() {
  --kept_works;
}

void tellWhatIsKept(const std::string& kept) {
  const std::lock_guard lock(words().mutex);
  words().kept = kept;
}

void endOfWork(int status) noexcept {
  final_status = status;
  while (is_ending.exchange(true)) pause();
}

}  // namespace palpate
