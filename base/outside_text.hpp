// SPDX-License-Identifier: Apache-2.0
// base/outside_text.hpp: text that comes from outside (a file's name, a key, a file in UTF-8), made fit for use.
#pragma once

#include <cstddef>
#include <string>
#include <string_view>

namespace palpate {

// Whether a terminal may take the byte as an order: those of ASCII. (Those of a code page would be parts of letters.)
[[nodiscard]] constexpr bool isControl(char c) noexcept {
  return static_cast<unsigned char>(c) < 0x20 || c == 0x7f;
}

// Fit for one line of a terminal. Every control character becomes '?', so a name can neither break the line nor steer
// the terminal.
[[nodiscard]] inline std::string oneLine(std::string text) {
  for (char& c : text) {
    if (isControl(c)) c = '?';
  }
  return text;
}

// Bytes of the character of UTF-8 that begins at `at`: 1 to 4; 0 where the bytes there are none.
[[nodiscard]] constexpr std::size_t characterBytes(std::string_view text, std::size_t at) noexcept {
  const auto byte = [&](std::size_t k) { return static_cast<unsigned char>(text[at + k]); };
  if (at >= text.size()) return 0;
  const unsigned char lead = byte(0);
  if (lead < 0x80) return 1;
  const std::size_t bytes = lead >= 0xC2 && lead < 0xE0   ? 2
                            : (lead & 0xF0U) == 0xE0      ? 3
                            : lead >= 0xF0 && lead < 0xF5 ? 4
                                                          : 0;
  if (bytes == 0 || at + bytes > text.size()) return 0;
  for (std::size_t k = 1; k < bytes; ++k) {
    if ((byte(k) & 0xC0U) != 0x80) return 0;
  }
  // No longer form of a shorter one, no surrogate, nothing beyond U+10FFFF.
  const bool good = (lead != 0xE0 || byte(1) >= 0xA0) && (lead != 0xED || byte(1) < 0xA0) &&
                    (lead != 0xF0 || byte(1) >= 0x90) && (lead != 0xF4 || byte(1) < 0x90);
  return good ? bytes : 0;
}

[[nodiscard]] constexpr bool isUtf8(std::string_view text) noexcept {
  for (std::size_t at = 0; at < text.size();) {
    const std::size_t bytes = characterBytes(text, at);
    if (bytes == 0) return false;
    at += bytes;
  }
  return true;
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
