// SPDX-License-Identifier: Apache-2.0
// apps/serve/asked_words.hpp: the words of a client's question (service/messages), checked before they are used. All
// throw Error(kBadInput) for words that break the rules. Any thread; no cost.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>

#include "service/messages/message.hpp"

namespace palpate {

void checkWords(const wire::AskT& ask, std::size_t least, std::size_t most);  // how many there are
void checkAbsolute(const std::string& file);
[[nodiscard]] std::uint64_t countOf(const std::string& word);  // of edits

// The sides of a picture.
inline constexpr int kLeastPixels = 16, kMostPixels = 4096;  // along a side
struct AskedPixels {
  int width = 0, height = 0;
};
[[nodiscard]] AskedPixels pixelsOf(const std::string& width, const std::string& height);

}  // namespace palpate
