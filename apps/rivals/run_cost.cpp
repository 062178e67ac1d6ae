// SPDX-License-Identifier: Apache-2.0
#include <chrono>

#include <sys/resource.h>

#include "apps/rivals/rivals.hpp"

namespace palpate {

RunCost costOf(const std::function<void()>& work) {
  const auto cpu_ms = [] {
    rusage usage{};
    getrusage(RUSAGE_SELF, &usage);
    const auto ms = [](const timeval& t) {
      return 1e3 * static_cast<double>(t.tv_sec) + 1e-3 * static_cast<double>(t.tv_usec);
    };
    return ms(usage.ru_utime) + ms(usage.ru_stime);
  };
  const double cpu_before_ms = cpu_ms();
  const auto start = std::chrono::steady_clock::now();
  work();
  const std::chrono::duration<double, std::milli> wall = std::chrono::steady_clock::now() - start;
  return {wall.count(), cpu_ms() - cpu_before_ms};
}

}  // namespace palpate
