// SPDX-License-Identifier: Apache-2.0
// tests/servo/loop/heap_watch.hpp: counts what the calling thread takes from the heap while it watches itself.
//
// Every allocation of the program is seen: malloc and its kin are interposed; under a sanitizer, which has its own
// malloc, its hook is used. operator new is built on malloc.
#pragma once

namespace palpate {

class HeapWatch {
 public:
  static void begin() noexcept;  // of the calling thread; the count starts at 0
  static void end() noexcept;
  [[nodiscard]] static long count() noexcept;  // of the last thread that watched, once it has ended
};

}  // namespace palpate
