// SPDX-License-Identifier: Apache-2.0
// base/child_process.hpp: runs work in a child process, within limits of memory and time.
//
// For libraries that may crash, hang or ask for all memory over a damaged file. Only the child is lost then.
// The child is a fork, so it sees all that the caller sees. What it changes stays in the child, except in shared memory
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
  std::size_t memory_bytes = std::size_t{512} << 20;  // beyond the caller's memory; no limit under a sanitizer [byte]
  double cpu_s = 4;                                   // processor time for one piece of work [s]
};

// Limits for a library that reads a file of `file_bytes` and may make `more_bytes` of data from it. It gets 4 s, and 1
// s more for each whole 4 MiB of the file.
[[nodiscard]] ChildLimits limitsForFile(double file_bytes, double more_bytes = 0);

// Why a piece of work did not finish.
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
  std::vector<std::string> results;     // of the pieces of work that finished, in order
  std::optional<ChildTrouble> trouble;  // of piece number results.size(); empty: all finished
};

// Runs work(0) to work(count - 1) in one child. Gives what they return, up to the first that does not finish. Throws
// Error, which names `input`: kIo if no process can be made or too few file descriptors are left for it; kCancelled if
// a signal from the user ended the child.
[[nodiscard]] ChildOutcome runInChild(const std::string& input, std::size_t count, const ChildLimits& limits,
                                      const std::function<std::string(std::size_t)>& work);

}  // namespace palpate
