// SPDX-License-Identifier: Apache-2.0
#include "apps/study/cell.hpp"

#include <fmt/format.h>

namespace palpate {

std::string cellKey(const BenchRow& parameters) {
  std::string key;
  for (const auto& [name, figure] : parameters) {
    const std::string value = std::visit([](const auto& v) { return fmt::format("{}", v); }, figure);
    key += fmt::format("{}{}={}", key.empty() ? "" : " ", name, value);
  }
  return key;
}

}  // namespace palpate
