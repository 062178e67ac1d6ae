// SPDX-License-Identifier: Apache-2.0
#include "apps/tune/quantity.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "base/error.hpp"

namespace palpate {
namespace quantity_test {

std::string refusalOf(double (*read)(const std::string&, const std::string&), const std::string& text) {
  try {
    static_cast<void>(read(text, "--x"));
    return "";
  } catch (const Error& error) {
    EXPECT_EQ(error.code(), Error::Code::kBadInput);
    return error.what();
  }
}

TEST(Quantity, IsANumberAndItsUnit) {
  EXPECT_EQ(forceOf_N("0.05N", "--error"), 0.05);
  EXPECT_EQ(forceOf_N("50mN", "--error"), 50 * 1e-3);
  EXPECT_EQ(forceOf_N("1e-3 kN", "--error"), 1e-3 * 1e3);
  EXPECT_EQ(timeOf_us("200us", "--budget"), 200);
  EXPECT_EQ(timeOf_us("0.2ms", "--budget"), 0.2 * 1e3);
  EXPECT_EQ(timeOf_us("800 ns", "--budget"), 800 * 1e-3);
  EXPECT_EQ(timeOf_us("1s", "--budget"), 1e6);
  for (const char* text : {"7us", "7 us", "7\u00b5s", "7 \u03bcs"}) EXPECT_EQ(timeOf_us(text, "--budget"), 7) << text;
  EXPECT_EQ(forceOf_N("7\u00b5N", "--error"), 7 * 1e-6);
}

TEST(Quantity, ComesBackFromItsText) {
  for (const double value : {0.05, 1e-9, 1.0 / 3, 123456.75, 5e-324, 1e300}) {
    EXPECT_EQ(forceOf_N(forceText(value), "x"), value);
    EXPECT_EQ(timeOf_us(timeText(value), "x"), value);
  }
}

TEST(Quantity, RefusesWhatIsNotOne) {
  using testing::HasSubstr;
  for (const char* text : {"", "N", "five N", "1,5N", "1 2N", "--1N"})
    EXPECT_THAT(refusalOf(forceOf_N, text), HasSubstr("number")) << text;
  EXPECT_THAT(refusalOf(forceOf_N, "0.05"), HasSubstr("no unit"));
  for (const char* text : {"0.05us", "0.05n", "0.05newton", "0.05NN", "5%", "5\u00b5", "5N\u00b5"})
    EXPECT_THAT(refusalOf(forceOf_N, text), HasSubstr("is no unit of it; use one of N, mN")) << text;
  EXPECT_THAT(refusalOf(timeOf_us, "5N"), HasSubstr("is no unit of it; use one of us, ms"));
  for (const char* text : {"0N", "-1N", "-0.0mN", "1e308kN", "1e999N"})
    EXPECT_NE(refusalOf(forceOf_N, text), "") << text;
  for (const char* text : {"nanN", "infN", "nan N", "inf N", "NaN", "inf"})
    EXPECT_NE(refusalOf(forceOf_N, text), "") << text;
}

}  // namespace quantity_test
}  // namespace palpate
