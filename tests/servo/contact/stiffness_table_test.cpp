// SPDX-License-Identifier: Apache-2.0
#include "servo/contact/stiffness_table.hpp"

#include <cmath>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "base/error.hpp"

namespace palpate {
namespace stiffness_table_test {

using testing::ElementsAre;

TEST(StiffnessTable, IsLinearBetweenRowsAndLevelBeyond) {
  const StiffnessTable table({{-100, 0.5}, {100, 1.5}, {300, 1}});
  EXPECT_EQ(table.factor(-1e9), 0.5);
  EXPECT_EQ(table.factor(-100), 0.5);
  EXPECT_EQ(table.factor(0), 1);
  EXPECT_EQ(table.factor(50), 1.25);
  EXPECT_EQ(table.factor(100), 1.5);
  EXPECT_EQ(table.factor(200), 1.25);
  EXPECT_EQ(table.factor(300), 1);
  EXPECT_EQ(table.factor(INFINITY), 1);
  EXPECT_EQ(table.factor(-INFINITY), 0.5);
  EXPECT_EQ(table.factor(NAN), 0.5);  // the first: any of the table would do
}

TEST(StiffnessTable, OneRowIsAConstant) {
  EXPECT_EQ(StiffnessTable({{7, 3}}).factor(-1), 3);
  EXPECT_EQ(StiffnessTable({{7, 3}}).factor(8), 3);
}

TEST(StiffnessTable, RefusesWhatCannotBeUsed) {
  const auto refusal = [](std::vector<StiffnessRow> rows) -> std::string {
    try {
      static_cast<void>(StiffnessTable(std::move(rows)));
    } catch (const Error& error) {
      EXPECT_EQ(error.code(), Error::Code::kBadInput);
      return error.what();
    }
    return "accepted";
  };
  EXPECT_EQ(refusal({}), "stiffness by density: the table has no row; give one or more");
  EXPECT_EQ(refusal({{1, 1}, {1, 2}}), "stiffness by density: density 1 comes after 1; give the rows in rising order");
  EXPECT_THAT(refusal({{2, 1}, {1, 2}}), testing::HasSubstr("density 1 comes after 2"));
  EXPECT_THAT(refusal({{NAN, 1}}), testing::HasSubstr("density nan"));
  EXPECT_THAT(refusal({{INFINITY, 1}}), testing::HasSubstr("density inf"));
  for (const double factor : {-0.1, 101.0, static_cast<double>(NAN), static_cast<double>(INFINITY)}) {
    EXPECT_THAT(refusal({{1, factor}}), testing::HasSubstr("cannot be used; give one from 0 to 100"));
  }
}

}  // namespace stiffness_table_test
}  // namespace palpate
