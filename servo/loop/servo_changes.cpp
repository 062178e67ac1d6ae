// SPDX-License-Identifier: Apache-2.0
#include "servo/loop/servo_changes.hpp"

#include <utility>

#include "base/error.hpp"

namespace palpate {

ServoChanges::~ServoChanges() {
  delete given_.load();
  for (const auto& slot : done_) delete slot.load();
}

std::uint64_t ServoChanges::give(ServoChange change) {
  if (change.force_limit_N)
    checkSetting(*change.force_limit_N > 0, "force limit", *change.force_limit_N, "give newtons above 0");
  auto next = std::make_unique<ServoChange>(std::move(change));
  const std::lock_guard lock(givers_);
  for (auto& slot : done_) delete slot.exchange(nullptr, std::memory_order_acquire);
  const std::unique_ptr<ServoChange> untaken(given_.exchange(nullptr, std::memory_order_acquire));
  if (untaken) {
    if (!next->algorithm) {
      next->algorithm = std::move(untaken->algorithm);
      next->doubtful = untaken->doubtful;
    }
    if (!next->force_limit_N) next->force_limit_N = untaken->force_limit_N;
  }
  const std::uint64_t number = ++given_count_;
  next->number = number;
  given_.store(next.release(), std::memory_order_release);
  return number;
}

void ServoChanges::withdraw() {
  const std::unique_ptr<ServoChange> untaken(given_.exchange(nullptr, std::memory_order_acquire));
}

ServoChange* ServoChanges::take() noexcept {
  if (given_.load(std::memory_order_relaxed) == nullptr) return nullptr;
  return given_.exchange(nullptr, std::memory_order_acquire);
}

void ServoChanges::done(ServoChange* change) noexcept {
  ended_.store(change->number, std::memory_order_release);
  for (auto& slot : done_) {
    if (slot.load(std::memory_order_relaxed) != nullptr) continue;
    slot.store(change, std::memory_order_release);
    return;
  }
}

}  // namespace palpate
