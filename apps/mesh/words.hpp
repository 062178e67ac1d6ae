// SPDX-License-Identifier: Apache-2.0
// apps/mesh/words.hpp: splits the text of a mesh file into words and numbers. Private to apps/mesh. Any thread.
#pragma once

#include <algorithm>
#include <charconv>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

#include "base/outside_text.hpp"

namespace palpate {

// Reads a text word by word. Blanks and line ends separate words.
class Words {
 public:
  explicit Words(std::string_view text) : text_(text) {}

  // The next word; "" at the end of the text.
  std::string_view next() {
    constexpr std::string_view kBlanks = " \t\r\n\v\f";
    at_ = std::min(text_.find_first_not_of(kBlanks, at_), text_.size());
    const std::size_t end = std::min(text_.find_first_of(kBlanks, at_), text_.size());
    const std::string_view word = text_.substr(at_, end - at_);
    at_ = end;
    return word;
  }
  // Skips the rest of the line.
  void skipLine() { at_ = std::min(text_.find_first_of("\r\n", at_), text_.size()); }
  [[nodiscard]] std::string_view rest() const { return text_.substr(at_); }

 private:
  std::string_view text_;
  std::size_t at_ = 0;
};

// The whole word as a number, empty if it is none. For a floating-point T "nan" and "inf" are numbers.
template <class T>
std::optional<T> numberOf(std::string_view word) {
  if (word.starts_with('+')) word.remove_prefix(1);
  T number = 0;
  const auto [end, code] = std::from_chars(word.data(), word.data() + word.size(), number);
  if (code != std::errc() || end != word.data() + word.size()) return {};
  return number;
}

// The words in quotes, cut to 40 characters and to one line, for a message.
inline std::string inQuotes(std::string_view words) {
  constexpr std::size_t kMost = 40;
  return '"' + oneLine(std::string(words.substr(0, kMost))) + (words.size() > kMost ? "...\"" : "\"");
}

}  // namespace palpate
