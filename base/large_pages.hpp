// SPDX-License-Identifier: Apache-2.0
// base/large_pages.hpp: asks the kernel for large pages below a block of memory that is about to be written for the
// first time: of 56 MiB, unpacked, the page faults of 4 KiB each take as long as the unpacking. A wish: where the
// kernel has none, or does not know the block, nothing changes. Any thread. Source: madvise(2), MADV_HUGEPAGE.
#pragma once

#include <cstddef>
#include <cstdint>

#include <sys/mman.h>

namespace palpate {

inline constexpr std::size_t kLargePageBytes = std::size_t{2} << 20U;

// The large pages that lie within the block as a whole; the next block's memory is left alone.
inline void wishLargePages(void* block, std::size_t bytes) noexcept {
  const auto begin = reinterpret_cast<std::uintptr_t>(block), end = begin + bytes;
  const std::uintptr_t first = (begin + kLargePageBytes - 1) / kLargePageBytes * kLargePageBytes;
  const std::uintptr_t last = end / kLargePageBytes * kLargePageBytes;
  if (first >= last) return;
  static_cast<void>(madvise(static_cast<std::byte*>(block) + (first - begin), last - first, MADV_HUGEPAGE));
}

}  // namespace palpate
