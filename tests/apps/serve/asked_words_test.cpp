// SPDX-License-Identifier: Apache-2.0
#include "apps/serve/asked_words.hpp"

#include <limits>

#include <fmt/format.h>
#include <gmock/gmock.h>

#include "tests/support/refusal.hpp"

namespace palpate {
namespace asked_words_test {

using testing::HasSubstr;

wire::AskT question(std::size_t words) {
  wire::AskT ask = asking(wire::Verb::Save);
  ask.words.resize(words);
  return ask;
}

TEST(AskedWords, AreAsManyAsTheQuestionTakes) {
  for (std::size_t words = 0; words < 8; ++words) {
    const std::string refusal = refusalOf([&] { checkWords(question(words), 2, 5); });
    if (words >= 2 && words <= 5) {
      EXPECT_EQ(refusal, kNoRefusal) << words;
    } else {
      EXPECT_THAT(refusal, HasSubstr(fmt::format("'Save' has {} words, not 2 to 5", words)));
    }
  }
}

TEST(AskedWords, NameFilesByTheirWholePaths) {
  EXPECT_EQ(refusalOf([] { checkAbsolute("/tmp/a.vdb"); }), kNoRefusal);
  for (const char* file : {"a.vdb", "./a.vdb", "~/a.vdb", " /a.vdb", ""})
    EXPECT_THAT(refusalOf([&] { checkAbsolute(file); }), HasSubstr("whole path")) << file;
}

TEST(AskedWords, CountEdits) {
  for (const std::uint64_t count : {std::uint64_t{0}, std::uint64_t{7}, std::numeric_limits<std::uint64_t>::max()})
    EXPECT_EQ(countOf(std::to_string(count)), count);
  for (const char* word : {"", "-1", "+1", " 1", "1 ", "1.0", "0x1", "one", "18446744073709551616"})
    EXPECT_THAT(refusalOf([&] { static_cast<void>(countOf(word)); }),
                HasSubstr(fmt::format("'{}' is no number", word)));
}

TEST(AskedWords, GiveTheSidesOfAPicture) {
  const AskedPixels pixels = pixelsOf("16", "4096");
  EXPECT_EQ(pixels.width, 16);
  EXPECT_EQ(pixels.height, 4096);
  const auto refusalFor = [](const char* width, const char* height) {
    return refusalOf([&] { static_cast<void>(pixelsOf(width, height)); });
  };
  for (const char* side : {"15", "4097", "0", "-64", "", "64px", "99999999999", "1e2"}) {
    EXPECT_THAT(refusalFor(side, "64"), HasSubstr(fmt::format("16 to 4096 pixels along a side, not {} x 64", side)));
    EXPECT_THAT(refusalFor("64", side), HasSubstr(fmt::format("16 to 4096 pixels along a side, not 64 x {}", side)));
  }
}

}  // namespace asked_words_test
}  // namespace palpate
