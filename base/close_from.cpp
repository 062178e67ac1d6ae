// SPDX-License-Identifier: Apache-2.0
#include "base/close_from.hpp"

#include <algorithm>

#include <fcntl.h>
#include <linux/close_range.h>
#include <sys/resource.h>
#include <sys/syscall.h>
#include <unistd.h>

namespace palpate {
namespace {

constexpr unsigned kLast = ~0U;
constexpr rlim_t kMostTried = 1U << 20U;  // the kernel's own limit for a process (fs.nr_open), as it is by default

// The hard limit: what was opened before the other one was lowered is open still.
unsigned lastThatMayBeOpen() noexcept {
  rlimit limit{};
  const bool is_known = getrlimit(RLIMIT_NOFILE, &limit) == 0;
  return static_cast<unsigned>(is_known ? std::min(limit.rlim_max, kMostTried) : kMostTried);
}

void closeRange(unsigned first, unsigned last, Closing closing) noexcept {
  if (first > last) return;
  const unsigned how = closing == Closing::kInPrograms ? CLOSE_RANGE_CLOEXEC : 0U;
  if (syscall(SYS_close_range, first, last, how) == 0) return;
  const unsigned end = std::min(last, lastThatMayBeOpen());
  for (unsigned one = first; one <= end; ++one) {
    if (closing == Closing::kInPrograms) {
      fcntl(static_cast<int>(one), F_SETFD, FD_CLOEXEC);
    } else {
      close(static_cast<int>(one));
    }
  }
}

}  // namespace

void closeFrom(int first, Closing closing, int kept) noexcept {
  const auto from = static_cast<unsigned>(first), but = static_cast<unsigned>(kept);
  if (kept < first) return closeRange(from, kLast, closing);
  if (but > from) closeRange(from, but - 1, closing);
  closeRange(but + 1, kLast, closing);
}

}  // namespace palpate
