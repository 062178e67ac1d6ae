// SPDX-License-Identifier: Apache-2.0
#include "apps/console/interrupt.hpp"

#include <csignal>

#include "base/error.hpp"

namespace palpate {
namespace {

volatile std::sig_atomic_t interrupt_flag = 0;

void note(int signal) {
  if (interrupt_flag != 0) {
    std::signal(signal, SIG_DFL);
    std::raise(signal);
  }
  interrupt_flag = 1;
}

}  // namespace

void catchInterrupts() {
  std::signal(SIGINT, note);
  std::signal(SIGTERM, note);
  std::signal(SIGXFSZ, SIG_IGN);  // a file size limit is then an error that names the file
}

bool interrupted() noexcept { return interrupt_flag != 0; }

void throwIfInterrupted(const std::string& work) {
  if (interrupted()) throw Error(Error::Code::kCancelled, work, "stopped by the user", "nothing was written; start it again");
}

}  // namespace palpate
