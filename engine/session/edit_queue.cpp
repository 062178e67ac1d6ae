// SPDX-License-Identifier: Apache-2.0
#include "engine/session/edit_queue.hpp"

#include <algorithm>
#include <utility>

namespace palpate {

EditQueue::EditQueue(std::size_t capacity) : capacity_(std::max<std::size_t>(capacity, 1)) {}

bool EditQueue::push(EditOrder order) {
  std::unique_lock lock(mutex_);
  room_.wait(lock, [&] { return queue_.size() < capacity_ || closed_ || abandoned_; });
  if (closed_ || abandoned_) return false;
  queue_.push_back(std::move(order));
  orders_.notify_one();
  return true;
}

void EditQueue::close() {
  fail(nullptr);
}

void EditQueue::fail(std::exception_ptr reason) {
  const std::lock_guard lock(mutex_);
  closed_ = true;
  if (!failure_) failure_ = std::move(reason);
  orders_.notify_all();
  room_.notify_all();
}

bool EditQueue::abandoned() const {
  const std::lock_guard lock(mutex_);
  return abandoned_;
}

std::optional<EditOrder> EditQueue::pop() {
  std::unique_lock lock(mutex_);
  orders_.wait(lock, [&] { return !queue_.empty() || closed_; });
  if (queue_.empty()) {
    if (failure_) std::rethrow_exception(failure_);
    return std::nullopt;
  }
  EditOrder order = std::move(queue_.front());
  queue_.pop_front();
  room_.notify_one();
  return order;
}

void EditQueue::abandon() {
  const std::lock_guard lock(mutex_);
  abandoned_ = true;
  queue_.clear();
  room_.notify_all();
}

}  // namespace palpate
