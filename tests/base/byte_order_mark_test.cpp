// SPDX-License-Identifier: Apache-2.0
#include "base/byte_order_mark.hpp"

#include <string>

#include <gtest/gtest.h>

namespace palpate {
namespace byte_order_mark_test {

TEST(ByteOrderMark, IsSkippedOnceAtTheBeginning) {
  const std::string mark(kByteOrderMark);
  EXPECT_EQ(withoutByteOrderMark(mark + "time_s"), "time_s");
  EXPECT_EQ(withoutByteOrderMark(mark), "");
  EXPECT_EQ(withoutByteOrderMark(mark + mark), mark);
  for (const std::string text : {"", "time_s", "\xEF\xBB", "\xFF\xFEt"}) EXPECT_EQ(withoutByteOrderMark(text), text);
  EXPECT_EQ(withoutByteOrderMark("a" + mark), "a" + mark);
}

}  // namespace byte_order_mark_test
}  // namespace palpate
