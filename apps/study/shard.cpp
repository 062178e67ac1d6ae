// SPDX-License-Identifier: Apache-2.0
#include "apps/study/shard.hpp"

#include <charconv>
#include <string_view>

#include <fmt/format.h>

#include "base/error.hpp"

namespace palpate {
namespace {

bool isWhole(std::string_view text, int& number) {
  const auto [end, code] = std::from_chars(text.data(), text.data() + text.size(), number);
  return code == std::errc() && end == text.data() + text.size();
}

}  // namespace

Shard shardOf(const std::string& text) {
  const std::size_t slash = text.find('/');
  Shard shard;
  const std::string_view all = text;
  const bool numbers = slash != std::string::npos && isWhole(all.substr(0, slash), shard.number) &&
                       isWhole(all.substr(slash + 1), shard.of);
  if (!numbers || shard.number < 1 || shard.number > shard.of || shard.of > kMostShards) {
    refuse(fmt::format("--shard {}", text), "it is not the I-th of N parts",
           fmt::format("write I/N with 1 <= I <= N <= {}: --shard 2/8", kMostShards));
  }
  return shard;
}

std::string shardWords(const Shard& shard) {
  return fmt::format(" --shard {}/{}", shard.number, shard.of);
}

std::vector<std::size_t> cellsOf(const Shard& shard, std::size_t cells) {
  std::vector<std::size_t> own;
  for (auto i = static_cast<std::size_t>(shard.number - 1); i < cells; i += static_cast<std::size_t>(shard.of)) {
    own.push_back(i);
  }
  return own;
}

}  // namespace palpate
