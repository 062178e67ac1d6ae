// SPDX-License-Identifier: Apache-2.0
// Waits for a file that another process makes.
#pragma once

#include <filesystem>

#include <unistd.h>

namespace palpate {

// True as soon as it is there; false if it is not after a time in which any process would have made it: half a minute.
[[nodiscard]] inline bool appears(const std::filesystem::path& file) {
  constexpr int kLooks = 30'000;
  constexpr useconds_t kBetween_us = 1000;
  for (int look = 0; look < kLooks; ++look) {
    if (std::filesystem::exists(file)) return true;
    usleep(kBetween_us);
  }
  return false;
}

}  // namespace palpate
