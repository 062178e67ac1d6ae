// SPDX-License-Identifier: Apache-2.0
#include "apps/console/interrupt.hpp"

#include <csignal>
#include <ctime>

#include "base/error.hpp"

namespace palpate {
namespace {

// One request may arrive twice: `timeout` signals its child and then the child's whole group.
constexpr double kSameRequest_s = 0.5;

volatile std::sig_atomic_t interrupt_flag = 0;
timespec first_request{};  // written and read by the handler only

double sinceFirstRequest_s() {
  timespec now{};
  clock_gettime(CLOCK_MONOTONIC, &now);  // allowed in a signal handler
  return static_cast<double>(now.tv_sec - first_request.tv_sec) +
         1e-9 * static_cast<double>(now.tv_nsec - first_request.tv_nsec);
}

void note(int signal) {
  if (interrupt_flag == 0) {
    clock_gettime(CLOCK_MONOTONIC, &first_request);
    interrupt_flag = 1;
  } else if (sinceFirstRequest_s() > kSameRequest_s) {
    std::signal(signal, SIG_DFL);
    std::raise(signal);
  }
}

}  // namespace

void catchInterrupts() {
  std::signal(SIGINT, note);
  std::signal(SIGTERM, note);
  std::signal(SIGHUP, note);      // the terminal was closed
  std::signal(SIGXFSZ, SIG_IGN);  // a file size limit is then an error that names the file
}

bool interrupted() noexcept {
  return interrupt_flag != 0;
}

void throwIfInterrupted(const std::string& work, const std::string& kept) {
  if (interrupted()) throw Error(Error::Code::kCancelled, work, "stopped by the user", kept);
}

}  // namespace palpate
