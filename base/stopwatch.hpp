// SPDX-License-Identifier: Apache-2.0
// base/stopwatch.hpp: seconds on the steady clock since it was made. Any thread; no cost but a look at the clock.
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
