// SPDX-License-Identifier: Apache-2.0
// tests/servo/support/tick_watch.hpp: counts the calling thread's allocations, frees and locks while it watches itself.
//
// It sees the whole program, libraries included: malloc and its kin, free, and the locks of pthreads are interposed.
// operator new and delete are built on malloc and free, the locks of C++ on those of pthreads. A sanitizer interposes
// the same functions itself. Under one, its hooks see the heap, and no lock is seen.
#pragma once

namespace palpate {

class TickWatch {
 public:
  struct Seen {
    long allocations = 0;
    long frees = 0;
    long locks = 0;  // taken or tried; waits for conditions and semaphores too
    [[nodiscard]] long all() const noexcept { return allocations + frees + locks; }
  };
  static void begin() noexcept;  // of the calling thread; the counts start at 0
  static void end() noexcept;
  [[nodiscard]] static Seen seen() noexcept;  // of the last thread that watched, once it has ended
  [[nodiscard]] static bool seesLocks() noexcept;
};

}  // namespace palpate
