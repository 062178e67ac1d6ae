// SPDX-License-Identifier: Apache-2.0
// base/child_process.hpp: work done in a child process, within limits. A library that crashes, hangs or asks for all
// memory over a damaged file then takes only the child with it.
//
// The child is a fork. It sees all that the caller sees. What it changes stays in the child, except in shared memory
// (base/shared_buffer.hpp). It has one thread, prints nothing, leaves no core file and dies with its parent. Linux
// only.
// Thread: a set-up thread, while no other thread is inside the library that the work calls. Cost: a fork.
#pragma once

#include <cstddef>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "base/error.hpp"

namespace palpate {

struct ChildLimits {
  std::size_t memory_bytes = std::size_t{512} << 20;  // beyond what the caller has; no limit under a sanitizer [byte]
  double cpu_s = 4;                                   // processor time for one piece of work [s]
};

// Limits for a library that reads a file of `file_bytes` and may make `more_bytes` of data from it. The time is 4 s,
// and 1 s more for each whole 4 MiB of the file.
[[nodiscard]] ChildLimits limitsForFile(double file_bytes, double more_bytes = 0);

// Why a piece of work did not come to its end.
struct ChildTrouble {
  enum class Kind {
    kError,      // it threw an Error: `error`
    kException,  // it threw something else: `words`
    kMemory,     // it asked for more than its limit, or the system killed it for want of memory
    kTooLong,    // it took longer than its limit
    kDied        // a signal killed it, or it ended the process
  };
  Kind kind = Kind::kDied;
  std::optional<Error> error;
  std::string words;  // one line, for a message: "it asks for more memory than a file of its size can need"
};

struct ChildOutcome {
  std::vector<std::string> results;     // of the pieces of work before the trouble, in order
  std::optional<ChildTrouble> trouble;  // of the piece with the number results.size()
};

// Runs work(0) to work(count - 1) in one child. Gives what they return, up to the first that does not come to its end.
// Throws Error, which names `input`: kIo where no process can be made or it could open hardly a file; kCancelled where
// a signal from the user ended the child.
[[nodiscard]] ChildOutcome runInChild(const std::string& input, std::size_t count, const ChildLimits& limits,
                                      const std::function<std::string(std::size_t)>& work);

}  // namespace palpate
