// SPDX-License-Identifier: Apache-2.0
// tests/damage/judge.hpp: reads a file in a process of its own and reports how that went. Linux. The calling process
// must have one thread only, so it may not have loaded a volume before.
#pragma once

#include <cstdint>
#include <string>

#include "tests/damage/whole_files.hpp"

namespace palpate::damage {

struct Limits {
  double seconds = 5;                   // processor time, the reader's children included [s]
  std::size_t memory_bytes = 2U << 30;  // resident memory of the reader or of its largest child [byte]
};

struct Verdict {
  enum class Kind {
    kRead,        // accepted
    kRefused,     // refused with a proper Error
    kBadMessage,  // refused with an Error of several lines, or one that does not name the input
    kThrown,      // threw something else
    kCrashed,
    kTooLong,
    kTooLarge
  };
  Kind kind = Kind::kCrashed;
  std::uint32_t fingerprint = 0;  // checksum of what was read: every value, vertex and length
  std::string words;              // the message, or why it crashed
  double seconds = 0;
  std::size_t memory_bytes = 0;
};

// `folder` holds the file as it is now.
[[nodiscard]] Verdict judge(const WholeFile& file, const std::string& folder, const Limits& limits);

// Whether the outcome is a failure, whatever the file held.
[[nodiscard]] inline bool isFailure(Verdict::Kind kind) {
  return kind != Verdict::Kind::kRead && kind != Verdict::Kind::kRefused;
}

}  // namespace palpate::damage
