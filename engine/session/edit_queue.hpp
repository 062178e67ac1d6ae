// SPDX-License-Identifier: Apache-2.0
// engine/session/edit_queue.hpp: a bounded queue of edits. Givers are the threads that put edits in. The taker is the
// engine's thread, which applies them.
//
// First in, first out; nothing is dropped. A giver waits while the queue is full. Nobody waits for ever. A taker that
// stops calls abandon(), which wakes the givers. A giver that ends calls close(), one that fails calls fail(); the
// taker learns of it after the last order. Threads: any number of givers, one taker; not for the servo. Memory:
// `capacity` orders, some 400 bytes and a short text each. Cost: a lock and a move.
#pragma once

#include <condition_variable>
#include <cstddef>
#include <deque>
#include <exception>
#include <mutex>
#include <optional>
#include <string>

#include "base/error.hpp"
#include "engine/edit/edit_text.hpp"

namespace palpate {

struct EditOrder {
  std::string where;  // names the order in messages: "--do 'undo'", "holes.txt line 12 'cut:point=...'"
  EditText text;
  std::optional<Error> refusal;  // why the text is no valid command; reported in its turn
};

class EditQueue {
 public:
  // `capacity`: the most orders that wait; 0 counts as 1.
  explicit EditQueue(std::size_t capacity);

  // Givers. push() waits while the queue is full. If the queue was abandoned or closed, it drops the order and returns
  // false.
  [[nodiscard]] bool push(EditOrder order);
  void close();                          // there will be no more orders
  void fail(std::exception_ptr reason);  // close(); after the last order pop() throws `reason`
  [[nodiscard]] bool abandoned() const;

  // Taker. pop() waits for an order. Empty: the queue was closed and all orders are taken. Throws the reason given to
  // fail().
  [[nodiscard]] std::optional<EditOrder> pop();
  void abandon();  // takes no more orders

 private:
  const std::size_t capacity_;
  mutable std::mutex mutex_;
  std::condition_variable room_;    // wakes givers: there is room, or the queue was abandoned
  std::condition_variable orders_;  // wakes the taker: there is an order, or the end
  std::deque<EditOrder> queue_;
  bool closed_ = false;
  bool abandoned_ = false;
  std::exception_ptr failure_;
};

}  // namespace palpate
