// SPDX-License-Identifier: Apache-2.0
#include "apps/sculpt/dated_name.hpp"

#include <fmt/chrono.h>
#include <fmt/format.h>

namespace palpate {

std::filesystem::path datedName(const std::filesystem::path& folder, const std::string& first,
                                const std::string& suffix, std::time_t now) {
  const std::string stem = fmt::format("{}-{:%Y%m%d-%H%M%S}", first, fmt::localtime(now));
  std::filesystem::path name = folder / (stem + suffix);
  std::error_code unknown;
  for (int number = 2; std::filesystem::exists(name, unknown); ++number) {
    name = folder / fmt::format("{}-{}{}", stem, number, suffix);
  }
  return name.lexically_normal();
}

}  // namespace palpate
