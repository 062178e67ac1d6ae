// SPDX-License-Identifier: Apache-2.0
#include "apps/serve/flat_heap.hpp"

#ifdef __GLIBC__
#include <malloc.h>
#endif

namespace palpate {

void keepHeapFlat() noexcept {
#ifdef __GLIBC__
  constexpr int kLarge_bytes = 128 << 10U;  // glibc's own first threshold, which it then keeps
  static_cast<void>(mallopt(M_MMAP_THRESHOLD, kLarge_bytes));
  static_cast<void>(mallopt(M_TRIM_THRESHOLD, kLarge_bytes));
  static_cast<void>(mallopt(M_ARENA_MAX, 2));
#endif
}

void giveFreeHeapBack() noexcept {
#ifdef __GLIBC__
  static_cast<void>(malloc_trim(0));
#endif
}

}  // namespace palpate
