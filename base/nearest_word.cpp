// SPDX-License-Identifier: Apache-2.0
#include "base/nearest_word.hpp"

#include <algorithm>
#include <limits>

namespace palpate {

std::size_t typingErrors(std::string_view a, std::string_view b) {
  // Three rows of the table of distances between prefixes of the words.
  std::vector<std::size_t> before(b.size() + 1), last(b.size() + 1), row(b.size() + 1);
  for (std::size_t j = 0; j <= b.size(); ++j) row[j] = j;
  for (std::size_t i = 1; i <= a.size(); ++i) {
    std::swap(before, last);
    std::swap(last, row);
    row[0] = i;
    for (std::size_t j = 1; j <= b.size(); ++j) {
      const std::size_t change = last[j - 1] + (a[i - 1] == b[j - 1] ? 0 : 1);
      row[j] = std::min({last[j] + 1, row[j - 1] + 1, change});
      if (i > 1 && j > 1 && a[i - 1] == b[j - 2] && a[i - 2] == b[j - 1]) row[j] = std::min(row[j], before[j - 2] + 1);
    }
  }
  return row[b.size()];
}

std::vector<std::string> nearestWords(std::string_view word, std::span<const std::string> known) {
  constexpr std::size_t kLeastLetters = 3;
  const std::size_t dashes = std::min(word.find_first_not_of('-'), word.size());
  const std::size_t letters = word.size() - dashes;
  std::vector<std::string> nearest;
  if (letters < kLeastLetters) return nearest;
  std::size_t errors = letters / 3;
  for (const std::string& candidate : known) {
    const std::size_t apart = typingErrors(word, candidate);
    if (apart > errors) continue;
    if (apart < errors) nearest.clear();
    errors = apart;
    nearest.push_back(candidate);
  }
  if (!nearest.empty()) return nearest;
  std::copy_if(known.begin(), known.end(), std::back_inserter(nearest),
               [&](const std::string& candidate) { return candidate.starts_with(word); });
  return nearest;
}

std::string didYouMean(std::span<const std::string> near) {
  if (near.empty()) return {};
  std::string text = "did you mean ";
  for (std::size_t i = 0; i < near.size(); ++i) {
    const char* between = i + 1 < near.size() ? ", " : " or ";
    text += (i == 0 ? "" : between) + near[i];
  }
  return text + "?";
}

std::string didYouMean(std::string_view word, std::span<const std::string> known) {
  return didYouMean(nearestWords(word, known));
}

std::string withDidYouMean(std::string_view word, std::span<const std::string> known, const std::string& remedy) {
  const std::string question = didYouMean(word, known);
  return question.empty() ? remedy : question + " " + remedy;
}

}  // namespace palpate
