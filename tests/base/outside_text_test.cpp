// SPDX-License-Identifier: Apache-2.0
#include "base/outside_text.hpp"

#include <string>

#include <gtest/gtest.h>

namespace palpate {
namespace outside_text_test {

// Letters beyond ASCII are no control characters, in whatever bytes they come.
TEST(OneLine, ReplacesControlCharactersAlone) {
  const std::string kept = " ~\xC3\xA4\x80\xFF";
  EXPECT_EQ(oneLine(kept), kept);
  EXPECT_EQ(oneLine(std::string("a\0b\x1F\x7F", 5)), "a?b??");
}

TEST(ByteOrderMark, IsSkippedOnceAtTheBeginning) {
  const std::string mark(kByteOrderMark);
  EXPECT_EQ(withoutByteOrderMark(mark + "time_s"), "time_s");
  EXPECT_EQ(withoutByteOrderMark(mark), "");
  EXPECT_EQ(withoutByteOrderMark(mark + mark), mark);
  for (const std::string text : {"", "time_s", "\xEF\xBB", "\xFF\xFEt"}) EXPECT_EQ(withoutByteOrderMark(text), text);
  EXPECT_EQ(withoutByteOrderMark("a" + mark), "a" + mark);
}

}  // namespace outside_text_test
}  // namespace palpate
