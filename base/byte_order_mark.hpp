// SPDX-License-Identifier: Apache-2.0
// base/byte_order_mark.hpp: the mark that Excel and some editors write in front of a text in UTF-8. It is no part of
// the text: every reader of a text format of ours skips it. (toml++ does so by itself.)
#pragma once

#include <string_view>

namespace palpate {

inline constexpr std::string_view kByteOrderMark = "\xEF\xBB\xBF";

// The text, which begins a file, behind its mark.
[[nodiscard]] constexpr std::string_view withoutByteOrderMark(std::string_view text) noexcept {
  if (text.starts_with(kByteOrderMark)) text.remove_prefix(kByteOrderMark.size());
  return text;
}

}  // namespace palpate
