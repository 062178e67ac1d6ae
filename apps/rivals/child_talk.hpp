// SPDX-License-Identifier: Apache-2.0
// apps/rivals/child_talk.hpp: a child process that answers lines with lines. One thread.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include <sys/types.h>

#include "base/leftover.hpp"

namespace palpate {

class ChildTalk {
 public:
  // `words`: the program, by its path, and its arguments. Its errors go where ours do. A program that cannot be
  // started is known by its first silence.
  explicit ChildTalk(const std::vector<std::string>& words);
  ~ChildTalk();  // ends the child, whatever it does
  ChildTalk(const ChildTalk&) = delete;
  ChildTalk& operator=(const ChildTalk&) = delete;

  bool tell(const std::string& line);  // false: it is gone
  // Its next line, without the end; waits as long as it lives. Nothing: it is gone. Throws Error(kCancelled) on Ctrl-C.
  [[nodiscard]] std::optional<std::string> hear();
  // Waits for its end. Its status, as waitpid() gives it; -1: it never was, or was waited for.
  int wait();

 private:
  pid_t child_ = -1;
  Leftover leftover_;
  int socket_ = -1;
  std::string heard_;  // the beginning of a line
};

}  // namespace palpate
