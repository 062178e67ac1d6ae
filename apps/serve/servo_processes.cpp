// SPDX-License-Identifier: Apache-2.0
#include "apps/serve/servo_processes.hpp"

#include <algorithm>
#include <cerrno>
#include <csignal>
#include <utility>

#include <poll.h>
#include <sys/syscall.h>
#include <unistd.h>

namespace palpate {

void ServoProcesses::note(std::int64_t process) {
  if (process <= 0) return;
  const std::lock_guard lock(mutex_);
  forgetEnded();
  if (std::ranges::find(all_, process, &One::process) != all_.end()) return;
  Descriptor life(static_cast<int>(syscall(SYS_pidfd_open, process, 0)));
  if (!life && errno == ESRCH) return;  // it has ended
  if (all_.size() >= kMost) all_.pop_front();
  all_.push_back({process, std::move(life)});
}

bool ServoProcesses::contains(std::int64_t process) {
  const std::lock_guard lock(mutex_);
  forgetEnded();
  return std::ranges::find(all_, process, &One::process) != all_.end();
}

// The descriptor of a process that has ended can be read. Without one its number must do.
void ServoProcesses::forgetEnded() {
  std::erase_if(all_, [](const One& one) {
    if (!one.life) return kill(static_cast<pid_t>(one.process), 0) != 0 && errno == ESRCH;
    pollfd ended = {.fd = one.life.get(), .events = POLLIN, .revents = 0};
    return poll(&ended, 1, 0) > 0;
  });
}

}  // namespace palpate
