// SPDX-License-Identifier: Apache-2.0
// apps/rivals/child_talk.hpp: a child process that is sent lines and answers with lines. One thread.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include <sys/types.h>

#include "base/leftover.hpp"

namespace palpate {

class ChildTalk {
 public:
  // `words`: the program's path and its arguments. Its stderr is ours. If the program cannot be started, the first
  // hear() returns nothing.
  explicit ChildTalk(const std::vector<std::string>& words);
  ~ChildTalk();  // kills the child if it still runs
  ChildTalk(const ChildTalk&) = delete;
  ChildTalk& operator=(const ChildTalk&) = delete;

  // Sends a line. False: the child has ended.
  bool tell(const std::string& line);
  // The child's next line, without its end. Waits as long as the child lives. Empty: it has ended. Throws
  // Error(kCancelled) on Ctrl-C.
  [[nodiscard]] std::optional<std::string> hear();
  // Waits for the child's end and returns its status as waitpid() does. -1: there is no child, or it was waited for.
  int wait();

 private:
  pid_t child_ = -1;
  Leftover leftover_;
  int socket_ = -1;
  std::string heard_;  // the beginning of a line
};

}  // namespace palpate
