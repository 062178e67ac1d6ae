// SPDX-License-Identifier: Apache-2.0
// servo/loop/live_ticks.hpp: shows the ticks of a running servo to one other thread: the newest tick, and all since the
// last look.
//
// Threads: add() by the servo, the rest by one reader. Wait-free on both sides. If the reader looks too seldom, the
// list misses ticks; the tick numbers show where. Memory: `capacity` records. Cost of add(): two copies of a record.
#pragma once

#include <atomic>
#include <cstddef>
#include <vector>

#include "servo/loop/tick_record.hpp"
#include "servo/window/triple_buffer.hpp"

namespace palpate {

class LiveTicks {
 public:
  explicit LiveTicks(std::size_t capacity) : ring_(capacity) {}

  void add(const TickRecord& record) noexcept {
    latest_.back() = record;
    latest_.publish();
    const std::size_t added = added_.load(std::memory_order_relaxed);
    if (added - taken_.load(std::memory_order_acquire) == ring_.size()) return;
    ring_[added % ring_.size()] = record;
    added_.store(added + 1, std::memory_order_release);
  }

  // The newest tick; tick -1 before the first. Valid until the next call.
  [[nodiscard]] const TickRecord& latest() noexcept { return latest_.latest(); }

  // Appends the ticks since the last call, in order.
  void take(std::vector<TickRecord>& records) {
    const std::size_t added = added_.load(std::memory_order_acquire);
    std::size_t taken = taken_.load(std::memory_order_relaxed);
    for (; taken != added; ++taken) records.push_back(ring_[taken % ring_.size()]);
    taken_.store(taken, std::memory_order_release);
  }

 private:
  std::vector<TickRecord> ring_;
  std::atomic<std::size_t> added_{0};
  std::atomic<std::size_t> taken_{0};
  TripleBuffer<TickRecord> latest_{TickRecord{.tick = -1}};
};

}  // namespace palpate
