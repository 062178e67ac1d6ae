// SPDX-License-Identifier: Apache-2.0
// apps/mesh/words.hpp: words and numbers of mesh files that are text. Private to apps/mesh. Any thread.
#pragma once

#include <algorithm>
#include <charconv>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

#include "base/one_line.hpp"

namespace palpate {

// Takes words off a text, from its beginning on. A word ends at a blank or at the end of a line.
class Words {
 public:
  explicit Words(std::string_view text) : text_(text) {}

  // "": there are no more.
  std::string_view next() {
    constexpr std::string_view kBlanks = " \t\r\n\v\f";
    at_ = std::min(text_.find_first_not_of(kBlanks, at_), text_.size());
    const std::size_t end = std::min(text_.find_first_of(kBlanks, at_), text_.size());
    const std::string_view word = text_.substr(at_, end - at_);
    at_ = end;
    return word;
  }
  // Leaves out what remains of the line.
  void skipLine() { at_ = std::min(text_.find_first_of("\r\n", at_), text_.size()); }
  [[nodiscard]] std::string_view rest() const { return text_.substr(at_); }

 private:
  std::string_view text_;
  std::size_t at_ = 0;
};

// The whole word as a number; "nan" and "inf" are numbers too, of double.
template <class T>
std::optional<T> numberOf(std::string_view word) {
  if (word.starts_with('+')) word.remove_prefix(1);
  T number = 0;
  const auto [end, code] = std::from_chars(word.data(), word.data() + word.size(), number);
  if (code != std::errc() || end != word.data() + word.size()) return {};
  return number;
}

// Fit for a message.
inline std::string inQuotes(std::string_view words) {
  constexpr std::size_t kMost = 40;
  return '"' + oneLine(std::string(words.substr(0, kMost))) + (words.size() > kMost ? "...\"" : "\"");
}

}  // namespace palpate
