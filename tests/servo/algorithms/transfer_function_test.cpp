// SPDX-License-Identifier: Apache-2.0
#include "servo/algorithms/transfer_function.hpp"

#include <cmath>
#include <limits>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "base/error.hpp"

namespace palpate {
namespace transfer_function_test {

const TransferTables kTables{{{-1000, 0, 0}, {0, 1, 4}, {100, 3, 2}}, {{10, 0}, {30, 1}}};

TEST(TransferFunction, IsLinearBetweenRowsAndConstantBeyond) {
  const TransferFunction f(kTables);
  struct Case {
    double density, gradient, force_N, viscosity;
  };
  for (const Case& c : {Case{-2000, 30, 0, 0}, Case{-1000, 30, 0, 0}, Case{-500, 30, 0.5, 2}, Case{0, 30, 1, 4},
                        Case{25, 30, 1.5, 3.5}, Case{100, 30, 3, 2}, Case{1e9, 30, 3, 2}, Case{100, 0, 0, 2},
                        Case{100, 10, 0, 2}, Case{100, 15, 0.75, 2}, Case{100, 1e9, 3, 2}}) {
    const auto value = f.at(c.density, c.gradient);
    EXPECT_DOUBLE_EQ(value.force_N, c.force_N) << c.density << " " << c.gradient;
    EXPECT_DOUBLE_EQ(value.viscosity_Ns_per_m, c.viscosity) << c.density << " " << c.gradient;
  }
}

TEST(TransferFunction, OneRowIsAConstantAndNoGradientRowsWeighOne) {
  const TransferFunction f(TransferTables{{{5, 2, 1}}, {}});
  for (double density : {-9.0, 5.0, 9.0}) {
    EXPECT_EQ(f.at(density, 0).force_N, 2);
    EXPECT_EQ(f.at(density, 1e6).viscosity_Ns_per_m, 1);
  }
}

TEST(TransferFunction, AForceIntoTheDenseIsTaken) {
  EXPECT_DOUBLE_EQ(TransferFunction(TransferTables{{{0, 0, 0}, {1, -2, 0}}, {}}).at(0.5, 0).force_N, -1);
}

TEST(TransferFunction, TheStandardOneIsFeltFromTheIsosurfaceOn) {
  const TransferFunction f(TransferFunction::standard(100, {400, 2e-3}));
  const double steep = 400 / (20 * 2e-3);
  EXPECT_EQ(f.at(100, steep).force_N, 0);
  EXPECT_DOUBLE_EQ(f.at(200, steep).force_N, 0.5 * TransferFunction::kStandardForce_N);
  EXPECT_DOUBLE_EQ(f.at(300, steep).force_N, TransferFunction::kStandardForce_N);
  EXPECT_DOUBLE_EQ(f.at(500, steep).viscosity_Ns_per_m, TransferFunction::kStandardViscosity_Ns_per_m);
  EXPECT_DOUBLE_EQ(f.at(300, 0.5 * steep).force_N, 0.5 * TransferFunction::kStandardForce_N);
  EXPECT_EQ(f.at(300, 0).force_N, 0);
  for (double contrast : {0.0, -5.0}) {  // of a field of one density: as if it were 1
    const TransferTables tables = TransferFunction::standard(1, {contrast, 1e-3});
    EXPECT_EQ(tables.density[1].density, 1.5);
    EXPECT_NO_THROW(static_cast<void>(TransferFunction(tables)));
  }
}

void expectRefused(const TransferTables& tables, const char* input, const char* reason) {
  try {
    const TransferFunction f(tables);
    ADD_FAILURE() << "accepted; expected: " << reason;
  } catch (const Error& error) {
    EXPECT_EQ(error.code(), Error::Code::kBadInput);
    EXPECT_THAT(error.what(), testing::StartsWith(input));
    EXPECT_THAT(error.what(), testing::HasSubstr(reason));
  }
}

TEST(TransferFunction, RefusesTablesThatCannotBeUsed) {
  const double nan = std::nan("");
  const double inf = std::numeric_limits<double>::infinity();
  const char* density = "haptization density";
  const char* gradient = "haptization gradient";
  expectRefused({}, density, "no rows");
  expectRefused({{{1, 0, 0}, {0, 0, 0}}, {}}, density, "row 2: its first number is not above");
  expectRefused({{{1, 0, 0}, {1, 2, 0}}, {}}, density, "row 2: its first number is not above");
  expectRefused({{{nan, 0, 0}}, {}}, density, "row 1: a number is not finite");
  expectRefused({{{0, inf, 0}}, {}}, density, "row 1: a number is not finite");
  expectRefused({{{0, 0, nan}}, {}}, density, "row 1: a number is not finite");
  expectRefused({{{0, 0, 0}, {1, 0, -0.1}}, {}}, density, "row 2: its viscosity is negative");
  expectRefused({{{0, 0, 0}}, {{5, 1}, {4, 1}}}, gradient, "row 2: its first number is not above");
  expectRefused({{{0, 0, 0}}, {{0, inf}}}, gradient, "row 1: a number is not finite");
  expectRefused({{{0, 0, 0}}, {{-1, 1}}}, gradient, "row 1: its gradient is negative");
  expectRefused({{{0, 0, 0}}, {{0, -1}}}, gradient, "row 1: its weight is negative");
}

}  // namespace transfer_function_test
}  // namespace palpate
