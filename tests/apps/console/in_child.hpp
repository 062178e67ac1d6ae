// SPDX-License-Identifier: Apache-2.0
// Runs work in a child process, and keeps what it wrote on standard error and how it ended.
#pragma once

#include <array>
#include <csignal>
#include <functional>
#include <string>

#include <sys/wait.h>
#include <unistd.h>

namespace palpate {

struct Ended {
  int status = -1;  // exit status; -1: ended by a signal
  int signal = 0;   // the signal that ended it; 0: none
  std::string err;
};

// `meanwhile` is called with the child's process id while `work` runs.
inline Ended inChild(const std::function<void()>& work, const std::function<void(pid_t)>& meanwhile = {}) {
  std::array<int, 2> err{};
  if (pipe(err.data()) != 0) return {};
  const pid_t child = fork();
  if (child == 0) {
    for (const int signal : {SIGINT, SIGTERM, SIGHUP, SIGPIPE}) std::signal(signal, SIG_DFL);
    dup2(err[1], STDERR_FILENO);
    close(err[0]);
    close(err[1]);
    work();
    _exit(0);
  }
  close(err[1]);
  if (meanwhile) meanwhile(child);
  Ended ended;
  char byte = 0;
  while (read(err[0], &byte, 1) == 1) ended.err += byte;
  close(err[0]);
  int status = 0;
  waitpid(child, &status, 0);
  if (WIFEXITED(status)) ended.status = WEXITSTATUS(status);
  if (WIFSIGNALED(status)) ended.signal = WTERMSIG(status);
  return ended;
}

}  // namespace palpate
