// SPDX-License-Identifier: Apache-2.0
// servo/loop/tick_recorder.hpp: the records of a run, in memory that is allocated before the first tick.
//
// Keeps the newest `capacity` ticks. Thread: next() by the servo, taken() after the run. Cost: next() a few
// instructions and no heap; taken() moves the records, and rotates them if more than `capacity` were made.
#pragma once

#include <cstddef>
#include <vector>

#include "servo/loop/tick_record.hpp"

namespace palpate {

class TickRecorder {
 public:
  explicit TickRecorder(std::size_t capacity);

  // A record to fill. All its bytes are zero, padding too, so equal runs are equal as bytes. Null with capacity 0.
  [[nodiscard]] TickRecord* next() noexcept;
  // The records in the order of their ticks; the recorder is empty afterwards.
  [[nodiscard]] std::vector<TickRecord> taken();

 private:
  std::vector<TickRecord> records_;
  std::size_t count_ = 0;  // records made since the start
};

}  // namespace palpate
