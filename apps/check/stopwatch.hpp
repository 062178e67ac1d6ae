// SPDX-License-Identifier: Apache-2.0
// apps/check/stopwatch.hpp: wall-clock seconds since it was made. Any thread.
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
