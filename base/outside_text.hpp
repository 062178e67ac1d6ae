// SPDX-License-Identifier: Apache-2.0
// base/outside_text.hpp: text that comes from outside (a file's name, a key, a file in UTF-8), made fit for use.
#pragma once

#include <string>
#include <string_view>

namespace palpate {

// Fit for one line of a terminal. Every control character becomes '?', so a name can neither break the line nor steer
// the terminal.
[[nodiscard]] inline std::string oneLine(std::string text) {
  for (char& c : text) {
    if (static_cast<unsigned char>(c) < 0x20 || c == 0x7f) c = '?';
  }
  return text;
}

// Excel and some editors write this mark at the beginning of a UTF-8 file. It is not part of the text.
inline constexpr std::string_view kByteOrderMark = "\xEF\xBB\xBF";

// The text of a whole file, without the mark. Every reader of a text format of ours skips it. (toml++ does so by
// itself.)
[[nodiscard]] constexpr std::string_view withoutByteOrderMark(std::string_view text) noexcept {
  if (text.starts_with(kByteOrderMark)) text.remove_prefix(kByteOrderMark.size());
  return text;
}

}  // namespace palpate
