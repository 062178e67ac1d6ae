// SPDX-License-Identifier: Apache-2.0
// Another process over the same shared memory.
#pragma once

#include <csignal>
#include <functional>

#include <sys/wait.h>
#include <unistd.h>

namespace palpate {

// Another process, which ends with `work` or is killed.
class OtherProcess {
 public:
  explicit OtherProcess(const std::function<void()>& work) : id_(fork()) {
    if (id_ != 0) return;
    work();
    _exit(0);
  }
  ~OtherProcess() {
    if (id_ <= 0) return;
    kill(id_, SIGKILL);
    static_cast<void>(end());
  }
  OtherProcess(const OtherProcess&) = delete;
  OtherProcess& operator=(const OtherProcess&) = delete;
  void stop() const { kill(id_, SIGKILL); }
  int end() {
    int status = -1;
    waitpid(id_, &status, 0);
    id_ = -1;
    return status;
  }

 private:
  pid_t id_;
};

}  // namespace palpate
