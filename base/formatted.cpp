// SPDX-License-Identifier: Apache-2.0
#include "base/formatted.hpp"

#include <array>
#include <charconv>

namespace palpate {

std::string asText(double number) {
  std::array<char, 32> text;
  const auto end = std::to_chars(text.data(), text.data() + text.size(), number, std::chars_format::general, 6);
  return {text.data(), end.ptr};
}

std::string filled(std::string_view pattern, std::initializer_list<std::string> texts) {
  std::string all;
  for (const std::string& text : texts) {
    const std::size_t at = pattern.find("{}");
    all.append(pattern.substr(0, at)).append(text);
    pattern.remove_prefix(at + 2);
  }
  return all.append(pattern);
}

}  // namespace palpate
