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

// Words of `known` that may have been meant: the nearest ones, if at most a third of the letters is wrong. Otherwise
// all that begin with the word. None for a word of less than three letters, which may be anything. Leading dashes are
// not counted as letters.
[[nodiscard]] std::vector<std::string> nearestWords(std::string_view word, std::span<const std::string> known);

// "did you mean --seconds?", "did you mean a, b or c?"; empty where nothing is near. With one argument: of words that
// the caller found to be near.
[[nodiscard]] std::string didYouMean(std::string_view word, std::span<const std::string> known);
[[nodiscard]] std::string didYouMean(std::span<const std::string> near);

// A remedy with that question in front: "did you mean touch? 'palpate --help' lists the verbs".
[[nodiscard]] std::string withDidYouMean(std::string_view word, std::span<const std::string> known,
                                         const std::string& remedy);

}  // namespace palpate
