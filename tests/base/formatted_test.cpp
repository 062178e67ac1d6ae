// SPDX-License-Identifier: Apache-2.0
#include "base/formatted.hpp"

#include <cmath>
#include <limits>
#include <random>

#include <fmt/format.h>
#include <gtest/gtest.h>

namespace palpate {
namespace formatted_test {

TEST(Formatted, PutsTextsIntoTheirPlaces) {
  EXPECT_EQ(formatted("row {}: {}", 3, "it is empty"), "row 3: it is empty");
  EXPECT_EQ(formatted("{}{}", std::string("a"), std::string_view("b")), "ab");
  EXPECT_EQ(formatted("nothing"), "nothing");
  EXPECT_EQ(formatted("{} at the end {}", -7, std::uint64_t{18446744073709551615U}),
            "-7 at the end 18446744073709551615");
  EXPECT_EQ(formatted("{}", "{} is not filled again"), "{} is not filled again");
}

// fmt's {:g}, and so printf's %g: of ordinary numbers, of all sizes, of bits by chance.
TEST(Formatted, NumbersAreThoseOfFmt) {
  std::mt19937_64 random(11);
  std::uniform_real_distribution<double> exponent(-320, 308);
  for (double number : {0.0, -0.0, 0.5, 500.0, 1e5, 999999.5, 1e6, 123456789.0, 1e-4, 9.99999e-5, 1e300, 5e-324,
                        HUGE_VAL, -HUGE_VAL, std::numeric_limits<double>::quiet_NaN()})
    EXPECT_EQ(asText(number), fmt::format("{:g}", number));
  for (int n = 0; n < 20000; ++n) {
    const double number = (n % 2 == 0 ? 1 : -1) * std::pow(10, exponent(random));
    ASSERT_EQ(asText(number), fmt::format("{:g}", number));
  }
}

TEST(Formatted, ListsWords) {
  EXPECT_EQ(listed(std::vector<std::string>{"a", "b", "c"}), "a, b, c");
  EXPECT_EQ(listed(std::vector<std::string>{"a", "b"}, "; "), "a; b");
  EXPECT_EQ(listed(std::vector<std::string>{}), "");
}

}  // namespace formatted_test
}  // namespace palpate
