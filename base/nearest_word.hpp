// SPDX-License-Identifier: Apache-2.0
// base/nearest_word.hpp: suggests which known word a mistyped one was meant to be. Any thread. Cost: some microseconds
// for a hundred known words.
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

// The words of `known` that may have been meant. These are the nearest ones, if at most a third of the letters is
// wrong; otherwise all that begin with `word`. None for a word of less than three letters, which may mean anything.
// Leading dashes do not count as letters.
[[nodiscard]] std::vector<std::string> nearestWords(std::string_view word, std::span<const std::string> known);

// "did you mean --seconds?", "did you mean a, b or c?"; empty if no word is near. With one argument, `near` holds the
// words to suggest.
[[nodiscard]] std::string didYouMean(std::string_view word, std::span<const std::string> known);
[[nodiscard]] std::string didYouMean(std::span<const std::string> near);

// A remedy with that question in front: "did you mean touch? 'palpate --help' lists the verbs".
[[nodiscard]] std::string withDidYouMean(std::string_view word, std::span<const std::string> known,
                                         const std::string& remedy);

}  // namespace palpate
