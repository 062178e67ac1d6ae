// SPDX-License-Identifier: Apache-2.0
// apps/console/call_program.hpp: runs this program again as a child process: a bench that must start from nothing, a
// scene that shall load only its own libraries. Linux only; set-up code.
#pragma once

#include <string>
#include <vector>

namespace palpate {

struct ProgramCall {
  std::vector<std::string> words = {};     // after its name
  std::string program = "/proc/self/exe";  // this one
  bool shows_messages = true;              // its messages go where this program's go; false: they are kept
};

struct ProgramEnd {
  int status = 0;             // that it ended with; a signal ended it: 0
  int signal = 0;             // that ended it; 0: none
  std::string failure = {};   // why it did not end with status 0, in words; empty: it did
  std::string messages = {};  // what it wrote on standard error, if that was kept
};

// Runs it and waits for its end. What it prints is dropped. Ctrl-C reaches it too, and this waits for its end. Throws
// Error(kIo) if no process can be started.
[[nodiscard]] ProgramEnd callProgram(const ProgramCall& call);

}  // namespace palpate
