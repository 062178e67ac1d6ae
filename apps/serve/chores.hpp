// SPDX-License-Identifier: Apache-2.0
// apps/serve/chores.hpp: a thread for what takes long and needs no engine: reading meshes, packing pictures. Work is
// done in order. Threads: add(), finish() and idle() by any.
#pragma once

#include <condition_variable>
#include <cstddef>
#include <deque>
#include <functional>
#include <mutex>
#include <stop_token>
#include <thread>

namespace palpate {

class Chores {
 public:
  using Work = std::function<void()>;  // throws nothing
  explicit Chores(const char* thread_name);
  ~Chores();  // does what is left
  Chores(const Chores&) = delete;
  Chores& operator=(const Chores&) = delete;

  void add(Work work);
  [[nodiscard]] bool idle() const;
  [[nodiscard]] std::size_t waiting() const;  // beside what it works at
  void finish();                              // waits until it is idle

 private:
  void run(const std::stop_token& stop, const char* thread_name);

  mutable std::mutex mutex_;
  std::condition_variable_any changed_;
  std::deque<Work> waiting_;
  bool works_ = false;
  std::jthread thread_;  // last member: it uses the others
};

}  // namespace palpate
