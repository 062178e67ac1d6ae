// SPDX-License-Identifier: Apache-2.0
// servo/devices/one_writer.hpp: counters that one thread alone counts up, and any thread reads.
//
// With one writer a load and a store are enough: fetch_add() would lock the cache line for other writers, of whom there
// are none. Wait-free. No heap, no errors.
#pragma once

#include <atomic>
#include <cstdint>

namespace palpate {

inline void countUp(std::atomic<std::uint64_t>& counter, std::uint64_t more = 1) noexcept {
  counter.store(counter.load(std::memory_order_relaxed) + more, std::memory_order_relaxed);
}

}  // namespace palpate
