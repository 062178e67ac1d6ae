// SPDX-License-Identifier: Apache-2.0
// tests/damage/judge.hpp: reads a file in a process of its own and says how that went. Linux. Thread: one, and nobody
// may have loaded a volume in this process before: it must have one thread.
#pragma once

#include <cstdint>
#include <string>

#include "tests/damage/whole_files.hpp"

namespace palpate::damage {

struct Limits {
  double seconds = 5;                   // of a processor, the reader's children included
  std::size_t memory_bytes = 2U << 30;  // resident, of the reader or the largest of its children
};

struct Verdict {
  enum class Kind {
    kRead,        // it was accepted
    kRefused,     // by an Error as it should be
    kBadMessage,  // by an Error of several lines, or that does not name the input
    kThrown,      // something else was thrown
    kCrashed,
    kTooLong,
    kTooLarge
  };
  Kind kind = Kind::kCrashed;
  std::uint32_t fingerprint = 0;  // of what was read: every value, vertex and length
  std::string words;              // the message; why it crashed
  double seconds = 0;
  std::size_t memory_bytes = 0;
};

// `folder` holds the file as it is now.
[[nodiscard]] Verdict judge(const WholeFile& file, const std::string& folder, const Limits& limits);

// Whether it is a failure whatever was in the file.
[[nodiscard]] inline bool isFailure(Verdict::Kind kind) {
  return kind != Verdict::Kind::kRead && kind != Verdict::Kind::kRefused;
}

}  // namespace palpate::damage
