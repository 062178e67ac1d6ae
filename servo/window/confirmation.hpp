// SPDX-License-Identifier: Apache-2.0
// servo/window/confirmation.hpp: when the writer last said that what it has published still holds.
//
// Store release, load acquire: whoever has seen a time sees all that the writer did before it said so, above all the
// publication of the window that it confirms. With relaxed order the reader could see the time and still the window
// before, and take an old window for a fresh one. No single value tears then, so no race of the payload tells:
// tests/servo/window reads, after a time, what was written before it, from a copy with relaxed order too, and the
// thread sanitizer reports that one. Threads: one writer, any readers. Cost: a store, a load. Errors, heap: none. Times
// on the servo's clock [ns].
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
