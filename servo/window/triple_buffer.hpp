// SPDX-License-Identifier: Apache-2.0
// servo/window/triple_buffer.hpp: hands the newest value from one thread to another: three slots, no lock.
//
// Threads: back() and publish() by the one writer, latest() by the one reader. Every call is wait-free on both sides:
// at most one atomic exchange, no retry. Cost: publish() one exchange; latest() one load, and one exchange if there is
// a new value. Errors: none. Heap: none after construction.
#pragma once

#include <array>
#include <atomic>
#include <cstdint>

namespace palpate {

// One slot is the back (the writer's), one the front (the reader's), one the middle. An atomic holds the number of the
// middle slot, and a bit that is set until the reader has taken that slot. Each side swaps its own slot for the middle.
//
// kSwap is the memory order of that swap. Release: a side has finished its reads and writes of the slot that it gives
// away before the other side gets it. Acquire: the same holds for the slot that it takes. Weaker orders tear:
// tests/servo/window instantiates a relaxed copy, and the thread sanitizer reports it.
template <class T, std::memory_order kSwap = std::memory_order_acq_rel>
class TripleBuffer {
 public:
  TripleBuffer() = default;
  // Every slot starts as `first`. Nothing counts as published: latest() gives `first` until the first publish().
  explicit TripleBuffer(const T& first) : slots_{Slot{first}, Slot{first}, Slot{first}} {}

  TripleBuffer(const TripleBuffer&) = delete;
  TripleBuffer& operator=(const TripleBuffer&) = delete;

  // Writer: the slot to fill, valid until publish(). It holds an older value.
  [[nodiscard]] T& back() noexcept { return slots_[back_].value; }
  // Writer: the number of back()'s slot: 0, 1 or 2. For storage that belongs to a slot.
  [[nodiscard]] unsigned backIndex() const noexcept { return back_; }
  // Writer: hands back() over; back() is another slot afterwards.
  void publish() noexcept { back_ = middle_.exchange(back_ | kFresh, kSwap) & kIndex; }

  // Reader: the newest published value; the reference is valid, and its content constant, until the next call.
  [[nodiscard]] const T& latest() noexcept {
    // Relaxed is enough here: the exchange below gives the order, and a missed bit is seen at the next call.
    if ((middle_.load(std::memory_order_relaxed) & kFresh) != 0) front_ = middle_.exchange(front_, kSwap) & kIndex;
    return slots_[front_].value;
  }

 private:
  static constexpr unsigned kIndex = 3;
  static constexpr unsigned kFresh = 4;
  static constexpr std::size_t kCacheLine = 64;  // [byte]; each side's slot and number on lines of their own
  static_assert(std::atomic<unsigned>::is_always_lock_free);

  struct alignas(kCacheLine) Slot {
    T value{};
  };
  std::array<Slot, 3> slots_{};
  alignas(kCacheLine) unsigned back_ = 0;
  alignas(kCacheLine) std::atomic<unsigned> middle_{1};
  alignas(kCacheLine) unsigned front_ = 2;
};

}  // namespace palpate
