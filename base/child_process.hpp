// SPDX-License-Identifier: Apache-2.0
// base/child_process.hpp: work done in a child process, within limits, so that a library which crashes, hangs or asks
// for all memory over a damaged file takes only the child with it.
//
// The child is a fork: it sees all that the caller sees, and what it changes stays there, but for memory that is shared
// (base/shared_buffer.hpp). It has one thread; it prints nothing, leaves no core file, and dies with its parent. Linux.
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
  std::size_t memory_bytes = std::size_t{512} << 20;  // more than the caller has [byte]; not under a sanitizer
  double cpu_s = 4;                                   // of a processor's time, for one piece of work [s]
};

// Limits for a library that reads a file of so many bytes and may make `more_bytes` of it. For a file below 1 MiB the
// time is 4 s.
[[nodiscard]] ChildLimits limitsForFile(double file_bytes, double more_bytes = 0);

// Why a piece of work did not come to its end.
struct ChildTrouble {
  enum class Kind {
    kError,      // it threw an Error: `error`
    kException,  // it threw something else: `words`
    kMemory,     // it asked for more than its limit
    kTooLong,    // more than its limit
    kDied        // by a signal, or it ended the process
  };
  Kind kind = Kind::kDied;
  std::optional<Error> error;
  std::string words;  // one line, for a message: "it asks for more memory than a file of its size can need"
};

struct ChildOutcome {
  std::vector<std::string> results;     // of the pieces before the trouble, in order
  std::optional<ChildTrouble> trouble;  // of piece results.size()
};

// Runs work(0) to work(count - 1) in one child and hands back what they return, up to the first that does not come to
// its end. Throws Error: kIo where no process can be made, which `input` is named for; kCancelled where a signal that a
// user sends ended the child.
[[nodiscard]] ChildOutcome runInChild(const std::string& input, std::size_t count, const ChildLimits& limits,
                                      const std::function<std::string(std::size_t)>& work);

}  // namespace palpate
