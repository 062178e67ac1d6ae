// SPDX-License-Identifier: Apache-2.0
#include "base/newest_values.hpp"

#include <deque>

#include <gtest/gtest.h>

namespace palpate {
namespace newest_values_test {

TEST(NewestValues, AreThoseOfAQueueOfThatLength) {
  for (const std::size_t most : {std::size_t{1}, std::size_t{2}, std::size_t{7}}) {
    NewestValues values(most);
    std::deque<double> expected;
    EXPECT_TRUE(values.inOrder().empty());
    for (int i = 0; i < 40; ++i) {
      values.add(i);
      expected.push_back(i);
      if (expected.size() > most) expected.pop_front();
      ASSERT_EQ(values.inOrder(), std::vector<double>(expected.begin(), expected.end())) << most << " " << i;
      ASSERT_EQ(values.count(), static_cast<std::uint64_t>(i + 1));
    }
  }
}

}  // namespace newest_values_test
}  // namespace palpate
