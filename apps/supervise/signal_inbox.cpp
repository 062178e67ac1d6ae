// SPDX-License-Identifier: Apache-2.0
#include "apps/supervise/signal_inbox.hpp"

#include <atomic>
#include <cerrno>
#include <cstdint>
#include <cstring>

#include <poll.h>
#include <sys/eventfd.h>
#include <unistd.h>

#include "base/error.hpp"

namespace palpate {
namespace {

constexpr std::array<int, 4> kInboxSignals = {SIGTERM, SIGINT, SIGHUP, SIGCHLD};

// A handler may still run in another thread when its inbox is gone. So these stay until the process ends.
std::array<std::atomic<int>, kInboxSignals.size()> counts{};
std::atomic<int> bell = -1;  // an eventfd
std::atomic<bool> has_inbox = false;

static_assert(std::atomic<int>::is_always_lock_free, "handlers take no lock");

std::size_t slotOf(int signal) noexcept {
  std::size_t slot = 0;
  while (slot + 1 < kInboxSignals.size() && kInboxSignals[slot] != signal) ++slot;
  return slot;
}

void putIntoInbox(int signal) {
  const int old_errno = errno;
  ++counts[slotOf(signal)];
  const std::uint64_t one = 1;
  static_cast<void>(!write(bell, &one, sizeof one));
  errno = old_errno;
}

}  // namespace

SignalInbox::SignalInbox() : before_{} {
  if (has_inbox.exchange(true)) refuse("supervise", "this process supervises others already", "end that first");
  if (bell < 0) bell = eventfd(0, EFD_CLOEXEC | EFD_NONBLOCK);
  if (bell < 0) {
    const int failure = errno;
    has_inbox = false;
    throw Error(Error::Code::kIo, "supervise",
                std::string("signals cannot be waited for (") + std::strerror(failure) + ")", kFreeDescriptors);
  }
  for (auto& count : counts) count = 0;
  struct sigaction ours {};
  ours.sa_handler = putIntoInbox;
  ours.sa_flags = SA_RESTART;
  sigfillset(&ours.sa_mask);
  for (std::size_t slot = 0; slot < kInboxSignals.size(); ++slot) {
    sigaction(kInboxSignals[slot], nullptr, &before_[slot]);
    if (kInboxSignals[slot] == SIGHUP && before_[slot].sa_handler == SIG_IGN) continue;
    sigaction(kInboxSignals[slot], &ours, nullptr);
  }
}

SignalInbox::~SignalInbox() {
  for (std::size_t slot = 0; slot < kInboxSignals.size(); ++slot) {
    sigaction(kInboxSignals[slot], &before_[slot], nullptr);
  }
  has_inbox = false;
}

void SignalInbox::wait(int most_ms) noexcept {
  pollfd rings{.fd = bell, .events = POLLIN, .revents = 0};
  static_cast<void>(poll(&rings, 1, most_ms));
  std::uint64_t count = 0;  // set back before the counts are taken: what comes in between rings again
  static_cast<void>(!read(bell, &count, sizeof count));
}

int SignalInbox::take(int signal) noexcept {
  return counts[slotOf(signal)].exchange(0);
}

}  // namespace palpate
