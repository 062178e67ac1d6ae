// SPDX-License-Identifier: Apache-2.0
// engine/session/edit_queue.hpp: the bounded queue between those who give edits and the engine's thread, which takes
// them.
//
// Orders come out in the order in which they went in, and none is dropped: where the queue is full, who gives one
// waits. Nobody waits for ever: a taker that goes (abandon()) wakes the givers, and a giver's end or failure reaches
// the taker behind the last order. Threads: givers any number, one taker. Memory: `capacity` orders, some 400 bytes
// and a short text each. Cost: a lock and a move. No part of the servo.
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
  std::string where;  // it in messages: "--do 'undo'", "holes.txt line 12 'cut:point=...'"
  EditText text;
  std::optional<Error> refusal;  // of a text that makes no command, to be told in its turn
};

class EditQueue {
 public:
  // At least one order fits.
  explicit EditQueue(std::size_t capacity);

  // Givers. push() waits while the queue is full; false: nobody takes orders any more, or the queue was closed, and
  // this one was not taken.
  [[nodiscard]] bool push(EditOrder order);
  void close();                          // there will be no more
  void fail(std::exception_ptr reason);  // the same, and why: pop() throws it behind the last order
  [[nodiscard]] bool abandoned() const;

  // The taker. pop() waits for an order; nothing: the queue was closed and is empty. Throws what fail() was given.
  [[nodiscard]] std::optional<EditOrder> pop();
  void abandon();  // takes no more

 private:
  const std::size_t capacity_;
  mutable std::mutex mutex_;
  std::condition_variable room_;    // givers: there is room, or nobody takes
  std::condition_variable orders_;  // the taker: there is an order, or the end
  std::deque<EditOrder> queue_;
  bool closed_ = false;
  bool abandoned_ = false;
  std::exception_ptr failure_;
};

}  // namespace palpate
