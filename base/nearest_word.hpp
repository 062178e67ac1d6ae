// SPDX-License-Identifier: Apache-2.0
// base/nearest_word.hpp: suggests what a mistyped word was meant to be, from a list of known words. Any thread. Cost:
// some microseconds for a hundred words.
#pragma once

#include <cstddef>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace palpate {

// How many edits turn one word into the other: a letter changed, added or removed, or two neighbours swapped. This is
// the optimal string alignment distance (Damerau 1964, without an edit inside a swapped pair).
[[nodiscard]] std::size_t typingErrors(std::string_view a, std::string_view b);

// Words of `known` that may have been meant: the nearest ones, if at most a third of the letters is wrong, or one
// letter in a short word. Otherwise all that begin with the word, if it has three letters. None for a single letter.
// Leading dashes are not counted as letters.
[[nodiscard]] std::vector<std::string> nearestWords(std::string_view word, std::span<const std::string> known);

// "did you mean --seconds?", "did you mean a, b or c?"; empty where nothing is near.
[[nodiscard]] std::string didYouMean(std::string_view word, std::span<const std::string> known);

}  // namespace palpate
