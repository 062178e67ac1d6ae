// SPDX-License-Identifier: Apache-2.0
// base/stopwatch.hpp: seconds on the steady clock since the stopwatch was made. Any thread. Cost: reading the clock.
#pragma once

#include <chrono>

namespace palpate {

class Stopwatch {
 public:
  [[nodiscard]] double seconds() const {
    return std::chrono::duration<double>(std::chrono::steady_clock::now() - start_).count();
  }

 private:
  std::chrono::steady_clock::time_point start_ = std::chrono::steady_clock::now();
};

}  // namespace palpate
