// SPDX-License-Identifier: Apache-2.0
#include "apps/serve/asked_words.hpp"

#include <charconv>
#include <optional>

#include <fmt/format.h>

#include "base/error.hpp"

namespace palpate {
namespace {

// A whole number and nothing else.
template <class Number>
std::optional<Number> numberOf(const std::string& word) {
  Number number = 0;
  const auto [end, problem] = std::from_chars(word.data(), word.data() + word.size(), number);
  if (problem != std::errc() || end != word.data() + word.size()) return std::nullopt;
  return number;
}

}  // namespace

void checkWords(const wire::AskT& ask, std::size_t least, std::size_t most) {
  if (ask.words.size() >= least && ask.words.size() <= most) return;
  refuse("the question",
         fmt::format("'{}' has {} words, not {} to {}", wire::EnumNameVerb(ask.verb), ask.words.size(), least, most),
         "ask with 'palpate ctl'");
}

void checkAbsolute(const std::string& file) {
  if (!file.starts_with('/')) refuse(file, "the service writes files whose whole path is named", "begin it with '/'");
}

std::uint64_t countOf(const std::string& word) {
  const std::optional<std::uint64_t> count = numberOf<std::uint64_t>(word);
  if (!count)
    refuse("the question", fmt::format("'{}' is no number of edits", word), "ask with 'palpate sculpt --connect'");
  return *count;
}

AskedPixels pixelsOf(const std::string& width, const std::string& height) {
  const AskedPixels asked = {numberOf<int>(width).value_or(0), numberOf<int>(height).value_or(0)};
  for (const int side : {asked.width, asked.height}) {
    if (side < kLeastPixels || side > kMostPixels)
      refuse("the picture",
             fmt::format("it has {} to {} pixels along a side, not {} x {}", kLeastPixels, kMostPixels, width, height),
             "name other sizes");
  }
  return asked;
}

}  // namespace palpate
