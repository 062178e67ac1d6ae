// SPDX-License-Identifier: Apache-2.0
#include "servo/loop/tick_recorder.hpp"

#include <algorithm>
#include <cstring>

namespace palpate {

// The records are written once here, so that no page fault comes while the loop runs.
TickRecorder::TickRecorder(std::size_t capacity) : records_(capacity) {}

TickRecord* TickRecorder::next() noexcept {
  if (records_.empty()) return nullptr;
  TickRecord* record = &records_[count_++ % records_.size()];
  std::memset(static_cast<void*>(record), 0, sizeof *record);
  return record;
}

std::vector<TickRecord> TickRecorder::taken() {
  if (count_ < records_.size()) {
    records_.resize(count_);
  } else if (!records_.empty()) {
    std::rotate(records_.begin(), records_.begin() + static_cast<std::ptrdiff_t>(count_ % records_.size()),
                records_.end());
  }
  count_ = 0;
  return std::move(records_);
}

}  // namespace palpate
