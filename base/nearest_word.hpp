// SPDX-License-Identifier: Apache-2.0
// base/nearest_word.hpp: what somebody meant who mistyped a word that must be one of a list. Any thread. Cost: some
// microseconds for a hundred words.
#pragma once

#include <cstddef>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace palpate {

// Letters to change, add or take away, or neighbours to swap, that turn one word into the other: the optimal string
// alignment distance (Damerau 1964 without an edit inside a swapped pair).
[[nodiscard]] std::size_t typingErrors(std::string_view a, std::string_view b);

// Those of `known` that may have been meant: the nearest, where that is near (a third of the letters wrong, one in the
// shortest words, of two letters); else all that begin with the word, if it has three. Dashes are no letters.
[[nodiscard]] std::vector<std::string> nearestWords(std::string_view word, std::span<const std::string> known);

// "did you mean --seconds?", "did you mean a, b or c?"; empty where nothing is near.
[[nodiscard]] std::string didYouMean(std::string_view word, std::span<const std::string> known);

}  // namespace palpate
