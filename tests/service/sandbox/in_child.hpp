// SPDX-License-Identifier: Apache-2.0
// Work in a child process, since what it gives up does not come back.
#pragma once

#include <cerrno>
#include <functional>

#include <sys/wait.h>
#include <unistd.h>

namespace palpate {

// What work() returns, from 0 to 255; below 0: minus the signal that killed it.
inline int resultInChild(const std::function<int()>& work) {
  const pid_t child = fork();
  if (child == 0) _exit(work());
  int status = 0;
  waitpid(child, &status, 0);
  return WIFSIGNALED(status) ? -WTERMSIG(status) : WEXITSTATUS(status);
}

// What errno says after a call that gives a number below 0 on failure; 0: it did not fail.
inline int errnoOf(const std::function<long()>& call) {
  errno = 0;
  return call() < 0 ? errno : 0;
}

}  // namespace palpate
