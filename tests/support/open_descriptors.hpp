// SPDX-License-Identifier: Apache-2.0
// tests/support/open_descriptors.hpp: how many descriptors this process has open, for tests that none is left behind.
// Linux.
#pragma once

#include <filesystem>
#include <iterator>

namespace palpate {

[[nodiscard]] inline long openDescriptors() {
  return std::distance(std::filesystem::directory_iterator("/proc/self/fd"), {});
}

}  // namespace palpate
