// SPDX-License-Identifier: Apache-2.0
// base/formatted.hpp: text with numbers and words in it, for servo/ and what it uses of base/, which need no library
// but Eigen (so not fmt). Any thread; allocates.
#pragma once

#include <concepts>
#include <cstddef>
#include <initializer_list>
#include <string>
#include <string_view>
#include <type_traits>

namespace palpate {

// A text with `count` places "{}". The compiler refuses another number of them.
template <std::size_t count>
class Pattern {
 public:
  consteval Pattern(const char* text)
      : text_(text) {  // NOLINT(google-explicit-constructor): so that it can be a literal
    std::size_t places = 0;
    for (std::size_t at = text_.find("{}"); at != text_.npos; at = text_.find("{}", at + 2)) ++places;
    if (places != count) throw "as many places {} as arguments are wanted";
  }
  [[nodiscard]] std::string_view text() const noexcept { return text_; }

 private:
  std::string_view text_;
};

// Up to six significant digits, as printf's %g in the "C" locale has them: "0.5", "1e+20", "nan".
[[nodiscard]] std::string asText(double number);
[[nodiscard]] inline std::string asText(std::string_view words) {
  return std::string(words);
}
template <std::integral Number>
[[nodiscard]] std::string asText(Number number) {
  return std::to_string(number);
}

// Puts the texts into the places of `pattern`, in order.
[[nodiscard]] std::string filled(std::string_view pattern, std::initializer_list<std::string> texts);

// formatted("row {}: {}", 3, "it is empty") is "row 3: it is empty".
template <class... Args>
[[nodiscard]] std::string formatted(Pattern<sizeof...(Args)> pattern, const Args&... args) {
  return filled(pattern.text(), {asText(args)...});
}

// "a, b, c", or with another text between the words.
template <class Words>
[[nodiscard]] std::string listed(const Words& words, std::string_view between = ", ") {
  std::string all;
  for (const auto& word : words) {
    if (!all.empty()) all += between;
    all += word;
  }
  return all;
}

}  // namespace palpate
