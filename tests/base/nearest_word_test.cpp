// SPDX-License-Identifier: Apache-2.0
#include "base/nearest_word.hpp"

#include <random>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/support/typo.hpp"

namespace palpate {
namespace nearest_word_test {

using testing::ElementsAre;
using testing::IsEmpty;

// The definition, letter by letter from the end: slow and obvious.
std::size_t byDefinition(const std::string& a, const std::string& b) {
  if (a.empty() || b.empty()) return a.size() + b.size();
  const std::string a1 = a.substr(0, a.size() - 1), b1 = b.substr(0, b.size() - 1);
  std::size_t best = byDefinition(a1, b1) + (a.back() == b.back() ? 0 : 1);
  best = std::min({best, byDefinition(a1, b) + 1, byDefinition(a, b1) + 1});
  if (a.size() > 1 && b.size() > 1 && a.back() == b1.back() && a1.back() == b.back())
    best = std::min(best, byDefinition(a1.substr(0, a1.size() - 1), b1.substr(0, b1.size() - 1)) + 1);
  return best;
}

TEST(TypingErrors, AreThoseOfTheDefinition) {
  std::mt19937 random(1);
  std::uniform_int_distribution<int> length(0, 6), letter('a', 'c');
  const auto word = [&] {
    std::string text(static_cast<std::size_t>(length(random)), ' ');
    for (char& c : text) c = static_cast<char>(letter(random));
    return text;
  };
  for (int i = 0; i < 500; ++i) {
    const std::string a = word(), b = word();
    EXPECT_EQ(typingErrors(a, b), byDefinition(a, b)) << a << " " << b;
  }
}

const std::vector<std::string> kFlags = {"--seconds",
                                         "--stiffness",
                                         "--stiffness-density",
                                         "--friction-static",
                                         "--friction-dynamic",
                                         "--friction-viscous",
                                         "--n",
                                         "--out",
                                         "-o"};

TEST(NearestWords, FindsWhatWasMistyped) {
  EXPECT_THAT(nearestWords("--second", kFlags), ElementsAre("--seconds"));
  EXPECT_THAT(nearestWords("--stifness", kFlags), ElementsAre("--stiffness"));
  EXPECT_THAT(nearestWords("--secnods", kFlags), ElementsAre("--seconds"));
  EXPECT_THAT(nearestWords("--uot", kFlags), ElementsAre("--out"));
  const std::vector<std::string> verbs = {"touch", "edit", "info"};
  EXPECT_THAT(nearestWords("tuoch", verbs), ElementsAre("touch"));
  EXPECT_THAT(nearestWords("Info", verbs), ElementsAre("info"));
}

// All that are equally near, in their order; what is farther, before or behind them, is not told.
TEST(NearestWords, GivesTheNearestAlone) {
  const std::vector<std::string> known = {"strengtxx", "strengtx", "strength1", "stremgtx", "strengthy"};
  EXPECT_THAT(nearestWords("strength", known), ElementsAre("strengtx", "strength1", "strengthy"));
}

TEST(NearestWords, GivesAllThatBeginSo) {
  EXPECT_THAT(nearestWords("--fric", kFlags),
              ElementsAre("--friction-static", "--friction-dynamic", "--friction-viscous"));
  EXPECT_THAT(nearestWords("--st", kFlags), IsEmpty());  // two letters may be anything
}

// A suggestion that nobody can have meant is worse than none.
TEST(NearestWords, GivesNoneWhereNothingIsNear) {
  for (const char* word : {"--wrong", "--fast", "-x", "3", "", "-", "--", "--colour"})
    EXPECT_THAT(nearestWords(word, kFlags), IsEmpty()) << word;
}

// What is suggested is the word, and with it only what is as near.
TEST(NearestWords, FindsAWordWithOneTypo) {
  forEachTypo(kFlags, [](const std::string& flag, const std::string& typed) {
    const std::vector<std::string> nearest = nearestWords(typed, kFlags);
    EXPECT_THAT(nearest, testing::Contains(flag)) << typed;
    for (const std::string& one : nearest) EXPECT_EQ(typingErrors(one, typed), 1U) << typed;
  });
}

// A third of its letters is none, so anything might be meant: 'nan' is not.
TEST(NearestWords, GivesNoneForTwoLetters) {
  const std::vector<std::string> known = {"nan", "n", "nn", "na"};
  for (const char* word : {"nx", "an", "--nx"}) EXPECT_THAT(nearestWords(word, known), IsEmpty()) << word;
}

TEST(DidYouMean, IsAQuestionOrNothing) {
  EXPECT_EQ(didYouMean("--second", kFlags), "did you mean --seconds?");
  EXPECT_EQ(didYouMean("--fric", kFlags), "did you mean --friction-static, --friction-dynamic or --friction-viscous?");
  EXPECT_EQ(didYouMean("--wrong", kFlags), "");
  EXPECT_EQ(didYouMean(std::vector<std::string>{"a", "b"}), "did you mean a or b?");
  EXPECT_EQ(didYouMean(std::vector<std::string>{}), "");
}

TEST(DidYouMean, StandsBeforeTheRemedy) {
  EXPECT_EQ(withDidYouMean("--second", kFlags, "look it up"), "did you mean --seconds? look it up");
  EXPECT_EQ(withDidYouMean("--wrong", kFlags, "look it up"), "look it up");
}

}  // namespace nearest_word_test
}  // namespace palpate
