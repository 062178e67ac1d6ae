// SPDX-License-Identifier: Apache-2.0
// base/waker.hpp: ends another thread's poll(2) early, as when there is something to send.
#pragma once

#include <string>

#include "base/descriptor.hpp"

namespace palpate {

class Waker {
 public:
  // Throws Error(kIo) for `whom` if the system has no descriptor left.
  explicit Waker(const std::string& whom);

  [[nodiscard]] int descriptor() const noexcept { return event_.get(); }  // can be read (POLLIN) once woken
  void wake() const noexcept;                                             // any thread
  void sleepAgain() const noexcept;  // until the next wake(); the thread that polls, before it looks what there is

 private:
  Descriptor event_;
};

}  // namespace palpate
