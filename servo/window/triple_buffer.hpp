// SPDX-License-Identifier: Apache-2.0
// servo/window/triple_buffer.hpp: hands the newest value from one thread to another: three slots, no lock.
//
// The slots may lie in memory that two processes share (TripleBlock); then each process has a TripleBuffer over them,
// and T is trivially copyable. What is found there is not believed: a slot's number is in range whatever the other side
// wrote. The value itself is for the reader to check, in a copy.
// Threads: back() and publish() by the one writer, latest() by the one reader. Every call is wait-free on both sides:
// at most one atomic exchange, no retry. Cost: publish() one exchange; latest() one load, and one exchange if there is
// a new value. Errors: none. Heap: none after construction.
#pragma once

#include <algorithm>
#include <array>
#include <atomic>
#include <cstdint>
#include <memory>

namespace palpate {

// What both sides see. One slot is the back (the writer's), one the front (the reader's), one the middle. `middle`
// holds the number of the middle slot, and a bit that is set until the reader has taken that slot. Each side swaps its
// own slot for the middle.
template <class T>
struct TripleBlock {
  static constexpr std::size_t kCacheLine = 64;  // [byte]; each slot and the number on lines of their own
  static_assert(std::atomic<std::uint32_t>::is_always_lock_free);

  struct alignas(kCacheLine) Slot {
    T value{};
  };
  TripleBlock() = default;
  explicit TripleBlock(const T& first) : slots{Slot{first}, Slot{first}, Slot{first}} {}

  std::array<Slot, 3> slots{};
  alignas(kCacheLine) std::atomic<std::uint32_t> middle{1};
};

// kSwap is the memory order of that swap. Release: a side has finished its reads and writes of the slot that it gives
// away before the other side gets it. Acquire: the same holds for the slot that it takes. Weaker orders tear:
// tests/servo/window instantiates a relaxed copy, and the thread sanitizer reports it.
template <class T, std::memory_order kSwap = std::memory_order_acq_rel>
class TripleBuffer {
 public:
  TripleBuffer() : own_(std::make_unique<TripleBlock<T>>()), block_(*own_) {}
  // Every slot starts as `first`. Nothing counts as published: latest() gives `first` until the first publish().
  explicit TripleBuffer(const T& first) : own_(std::make_unique<TripleBlock<T>>(first)), block_(*own_) {}
  // One side over a block that neither side has used. It outlives this object.
  explicit TripleBuffer(TripleBlock<T>& shared) noexcept : block_(shared) {}

  TripleBuffer(const TripleBuffer&) = delete;
  TripleBuffer& operator=(const TripleBuffer&) = delete;

  // Writer: the slot to fill, valid until publish(). It holds an older value.
  [[nodiscard]] T& back() noexcept { return block_.slots[back_].value; }
  // Writer: the number of back()'s slot: 0, 1 or 2. For storage that belongs to a slot.
  [[nodiscard]] unsigned backIndex() const noexcept { return back_; }
  // Writer: hands back() over; back() is another slot afterwards.
  void publish() noexcept { back_ = slotOf(block_.middle.exchange(back_ | kFresh, kSwap)); }

  // Reader: takes the newest published value, if it is another one than the last.
  [[nodiscard]] bool renew() noexcept {
    // Relaxed is enough here: the exchange below gives the order, and a missed bit is seen at the next call.
    if ((block_.middle.load(std::memory_order_relaxed) & kFresh) == 0) return false;
    front_ = slotOf(block_.middle.exchange(front_, kSwap));
    return true;
  }
  // Reader: what renew() took last, valid until its next call; and the number of its slot.
  [[nodiscard]] const T& front() const noexcept { return block_.slots[front_].value; }
  [[nodiscard]] unsigned frontIndex() const noexcept { return front_; }

  // Reader: the newest published value; the reference is valid, and its content constant, until the next call.
  [[nodiscard]] const T& latest() noexcept {
    static_cast<void>(renew());
    return front();
  }

 private:
  static constexpr std::uint32_t kIndex = 3;
  static constexpr std::uint32_t kFresh = 4;
  static unsigned slotOf(std::uint32_t word) noexcept { return std::min(word & kIndex, std::uint32_t{2}); }

  std::unique_ptr<TripleBlock<T>> own_;
  TripleBlock<T>& block_;
  alignas(TripleBlock<T>::kCacheLine) unsigned back_ = 0;   // the writer's line
  alignas(TripleBlock<T>::kCacheLine) unsigned front_ = 2;  // the reader's
};

}  // namespace palpate
