// SPDX-License-Identifier: Apache-2.0
// servo/window/confirmation.hpp: the time at which the writer last said that its newest publication still holds.
//
// Store release, load acquire: a reader that sees a time also sees all that the writer did before it. Above all it sees
// the window that the time confirms. With relaxed order the reader could see the time together with the previous
// window, and take an old window for a fresh one.
// Relaxed order tears no single value, so the thread sanitizer finds nothing in this class alone. tests/servo/window
// therefore reads data that was written before the time. It does so through a copy with relaxed order too, which the
// sanitizer reports.
// Threads: one writer, any readers. Cost: a store, a load. Errors, heap: none. Times on the servo's clock [ns].
#pragma once

#include <atomic>
#include <cstdint>

namespace palpate {

template <std::memory_order kStore = std::memory_order_release, std::memory_order kLoad = std::memory_order_acquire>
class Confirmation {
 public:
  void confirm(std::int64_t now_ns) noexcept { at_ns_.store(now_ns, kStore); }
  [[nodiscard]] std::int64_t at_ns() const noexcept { return at_ns_.load(kLoad); }

 private:
  alignas(64) std::atomic<std::int64_t> at_ns_{0};
};

}  // namespace palpate
