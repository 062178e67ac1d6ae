// SPDX-License-Identifier: Apache-2.0
// tests/support/typo.hpp: slips of the fingers, for tests that the word that was meant is suggested.
#pragma once

#include <algorithm>
#include <cstddef>
#include <random>
#include <string>
#include <utility>
#include <vector>

namespace palpate {

// The word with one letter changed, added or removed, or with two neighbours swapped. Dashes in front stay.
inline std::string withTypo(const std::string& word, std::mt19937& random) {
  const auto below = [&](std::size_t n) { return std::uniform_int_distribution<std::size_t>(0, n - 1)(random); };
  const std::size_t dashes = std::min(word.find_first_not_of('-'), word.size());
  const std::size_t letters = word.size() - dashes;
  const auto letter = [&] { return static_cast<char>('a' + below(26)); };
  std::string typed = word;
  while (typed == word) {
    const std::size_t at = dashes + below(letters);
    switch (below(4)) {
      case 0:
        typed[at] = letter();
        break;
      case 1:
        typed.insert(typed.begin() + static_cast<std::ptrdiff_t>(at), letter());
        break;
      case 2:
        typed.erase(at, 1);
        break;
      default:
        if (at + 1 < typed.size()) std::swap(typed[at], typed[at + 1]);
    }
  }
  return typed;
}

// Calls check(word, typed) for many slips in each of the words: all from which a word can be told, so none that is
// shorter than three letters, and none that is another of the words.
template <typename Check>
void forEachTypo(const std::vector<std::string>& words, const Check& check) {
  std::mt19937 random(1);
  for (const std::string& word : words) {
    for (int n = 0; n < 40; ++n) {
      const std::string typed = withTypo(word, random);
      const std::size_t letters = typed.size() - std::min(typed.find_first_not_of('-'), typed.size());
      if (letters >= 3 && std::find(words.begin(), words.end(), typed) == words.end()) check(word, typed);
    }
  }
}

// What a message asks for behind "did you mean", up to its question mark; "" where it does not.
inline std::string suggestedIn(const std::string& message) {
  const std::string begin = "did you mean ";
  const std::size_t at = message.find(begin);
  if (at == std::string::npos) return "";
  const std::size_t from = at + begin.size();
  return message.substr(from, message.find('?', from) - from);
}

}  // namespace palpate
