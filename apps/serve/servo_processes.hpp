// SPDX-License-Identifier: Apache-2.0
// apps/serve/servo_processes.hpp: which processes have been servos of this service, as long as they live.
//
// A process is known by its number, and the kernel is asked whether it still lives: another one that comes to have the
// number later is not meant. Where the kernel gives no descriptor for that (none is left, or it is older than 5.3) that
// other one is taken for a servo, too, rather than a servo for none. Any thread. Some system calls.
#pragma once

#include <cstddef>
#include <cstdint>
#include <list>
#include <mutex>

#include "base/descriptor.hpp"

namespace palpate {

class ServoProcesses {
 public:
  static constexpr std::size_t kMost = 64;  // each needs a descriptor; of more the one that came first is forgotten

  void note(std::int64_t process);  // 0: not known, which is nobody
  [[nodiscard]] bool contains(std::int64_t process);

 private:
  struct One {
    std::int64_t process = 0;
    Descriptor life;  // pidfd_open(2); none: the kernel gave none
  };
  void forgetEnded();

  std::mutex mutex_;  // guards the next
  std::list<One> all_;
};

}  // namespace palpate
