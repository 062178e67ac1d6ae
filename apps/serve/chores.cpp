// SPDX-License-Identifier: Apache-2.0
#include "apps/serve/chores.hpp"

#include <utility>

#include "base/thread_names.hpp"

namespace palpate {

Chores::Chores(const char* thread_name)
    : thread_([this, thread_name](const std::stop_token& stop) { run(stop, thread_name); }) {}

Chores::~Chores() {
  finish();
}

void Chores::add(Work work) {
  {
    const std::lock_guard lock(mutex_);
    waiting_.push_back(std::move(work));
  }
  changed_.notify_all();
}

bool Chores::idle() const {
  const std::lock_guard lock(mutex_);
  return waiting_.empty() && !works_;
}

std::size_t Chores::waiting() const {
  const std::lock_guard lock(mutex_);
  return waiting_.size();
}

void Chores::finish() {
  std::unique_lock lock(mutex_);
  changed_.wait(lock, [this] { return waiting_.empty() && !works_; });
}

void Chores::run(const std::stop_token& stop, const char* thread_name) {
  nameThisThread(thread_name);
  std::unique_lock lock(mutex_);
  while (changed_.wait(lock, stop, [this] { return !waiting_.empty(); })) {
    const Work work = std::move(waiting_.front());
    waiting_.pop_front();
    works_ = true;
    lock.unlock();
    work();
    lock.lock();
    works_ = false;
    changed_.notify_all();
  }
}

}  // namespace palpate
