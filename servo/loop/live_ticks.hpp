// SPDX-License-Identifier: Apache-2.0
// servo/loop/live_ticks.hpp: shows the ticks of a running servo to one other thread: the newest tick, and all since the
// last look.
//
// Threads: add() by the servo, the rest by one reader. Wait-free on both sides. If the reader looks too seldom, the
// list misses ticks; the tick numbers show where. Memory: `capacity` records, above 0. Cost of add(): two copies of a
// record. The two may be processes that share block and ring; counts that are found there are not believed.
#pragma once

#include <atomic>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <vector>

#include "servo/loop/tick_record.hpp"
#include "servo/window/triple_buffer.hpp"

namespace palpate {

// What both sides see, beside the ring of records.
struct LiveTicksBlock {
  TripleBlock<TickRecord> latest{TickRecord{.tick = -1}};
  alignas(64) std::atomic<std::uint64_t> added{0};
  alignas(64) std::atomic<std::uint64_t> taken{0};
};

class LiveTicks {
 public:
  explicit LiveTicks(std::size_t capacity)
      : own_(std::make_unique<Own>(capacity)), block_(own_->block), ring_(own_->ring.data()), capacity_(capacity) {}
  // One side over memory that neither side has used, and which outlives this.
  LiveTicks(LiveTicksBlock& shared, TickRecord* ring, std::size_t capacity) noexcept
      : block_(shared), ring_(ring), capacity_(capacity) {}

  void add(const TickRecord& record) noexcept {
    latest_.back() = record;
    latest_.publish();
    if (added_ - block_.taken.load(std::memory_order_acquire) >= capacity_) return;
    ring_[added_ % capacity_] = record;
    block_.added.store(++added_, std::memory_order_release);
  }

  // The newest tick; tick -1 before the first. Valid until the next call.
  [[nodiscard]] const TickRecord& latest() noexcept { return latest_.latest(); }

  // Appends the ticks since the last call, in order.
  void take(std::vector<TickRecord>& records) {
    const std::uint64_t added = block_.added.load(std::memory_order_acquire);
    if (added - taken_ > capacity_) taken_ = added;  // no servo counts so
    for (; taken_ != added; ++taken_) records.push_back(ring_[taken_ % capacity_]);
    block_.taken.store(taken_, std::memory_order_release);
  }

 private:
  struct Own {
    explicit Own(std::size_t capacity) : ring(capacity) {}
    LiveTicksBlock block;
    std::vector<TickRecord> ring;
  };
  std::unique_ptr<Own> own_;  // null: the memory is shared
  LiveTicksBlock& block_;
  TickRecord* const ring_;
  const std::size_t capacity_;
  alignas(64) std::uint64_t added_ = 0;  // the servo's
  alignas(64) std::uint64_t taken_ = 0;  // the reader's
  TripleBuffer<TickRecord> latest_{block_.latest};
};

}  // namespace palpate
