// SPDX-License-Identifier: Apache-2.0
#include "base/process_start.hpp"

#include <time.h>

namespace palpate {
namespace {

std::int64_t read_ns(clockid_t clock) noexcept {
  timespec time{};
  clock_gettime(clock, &time);
  return time.tv_sec * std::int64_t{1'000'000'000} + time.tv_nsec;
}

}  // namespace

std::int64_t processStart_ns() noexcept {
  static const std::int64_t start_ns = read_ns(CLOCK_MONOTONIC) - read_ns(CLOCK_PROCESS_CPUTIME_ID);
  return start_ns;
}

}  // namespace palpate
