// SPDX-License-Identifier: Apache-2.0
// base/end_with_parent.hpp: a child that outlives whoever started it would go on for nobody. Linux.
#pragma once

#include <sys/prctl.h>
#include <unistd.h>

namespace palpate {

// In a child that was just forked: it gets `signal` when the thread that forked it ends, and ends now if that has ended
// already. `parent`: getpid() before the fork. Only system calls that a signal handler may make.
inline void endWithParent(pid_t parent, int signal) noexcept {
  prctl(PR_SET_PDEATHSIG, signal, 0, 0, 0);
  if (getppid() != parent) _exit(0);  // it died before the line above
}

}  // namespace palpate
