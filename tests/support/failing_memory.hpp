// SPDX-License-Identifier: Apache-2.0
// An allocator that counts and, when asked to, fails. Include it in one source file of a test: it replaces the
// program's. Counted, and failed, are allocations of this thread by Palpate's own code: drivers and layers do not
// expect one to fail. Where there are none, those that the standard library makes for it may be as well.
#pragma once

#include <cstddef>
#include <cstdlib>
#include <new>

namespace failing_memory {

inline thread_local std::size_t allocations = 0;
inline thread_local std::size_t allocation_to_fail = 0;  // by the count above; 0: none
inline thread_local bool also_in_libraries = false;
inline thread_local std::size_t single_floats = 0;  // of those allocations, such as bricks of one density make

inline void failAfter(std::size_t more) {
  allocation_to_fail = allocations + more;
}
inline void failNoMore() {
  allocation_to_fail = 0;
}

}  // namespace failing_memory

extern "C" const char __executable_start, etext;  // NOLINT(bugprone-reserved-identifier): the linker's names

[[gnu::noinline]] void* operator new(std::size_t bytes) {
  const auto* caller = static_cast<const char*>(__builtin_return_address(0));
  if (failing_memory::also_in_libraries || (caller >= &__executable_start && caller < &etext)) {
    if (++failing_memory::allocations == failing_memory::allocation_to_fail) throw std::bad_alloc();
    failing_memory::single_floats += bytes == sizeof(float) ? 1 : 0;
  }
  if (void* memory = std::malloc(bytes == 0 ? 1 : bytes); memory != nullptr) return memory;
  throw std::bad_alloc();
}
[[gnu::noinline]] void operator delete(void* memory) noexcept {
  std::free(memory);
}
[[gnu::noinline]] void operator delete(void* memory, std::size_t) noexcept {
  std::free(memory);
}
