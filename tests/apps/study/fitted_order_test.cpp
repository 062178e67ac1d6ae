// SPDX-License-Identifier: Apache-2.0
#include "apps/study/fitted_order.hpp"

#include <cmath>
#include <random>
#include <vector>

#include <gtest/gtest.h>

namespace palpate {
namespace fitted_order_test {

std::vector<SizeAndError> powerLaw(double constant, double order, const std::vector<double>& sizes) {
  std::vector<SizeAndError> points;
  for (const double h : sizes) points.push_back({h, constant * std::pow(h, order)});
  return points;
}

// Logarithms and sums of some numbers of size 10 round by some 1e-15 each.
TEST(FittedOrder, IsThePowerOfAPowerLaw) {
  std::mt19937 bits(1);
  for (int trial = 0; trial < 1000; ++trial) {
    const double order = 0.01 * static_cast<double>(bits() % 800) - 2;
    const double constant = std::pow(10.0, static_cast<double>(bits() % 20) - 10);
    std::vector<double> sizes(2 + bits() % 8);
    for (double& h : sizes) h = 1e-4 * (1 + static_cast<double>(bits() % 1000));
    sizes[1] = 2 * sizes[0];  // not all equal
    EXPECT_NEAR(fittedOrder(powerLaw(constant, order, sizes)), order, 1e-11);
  }
}

// By hand: logarithms to base 2 are x = 0, 1, 2 and y = 0, 3, 3; the slope of least squares is 3 / 2.
TEST(FittedOrder, IsTheSlopeOfLeastSquares) {
  const std::vector<SizeAndError> points = {{1, 1}, {2, 8}, {4, 8}};
  EXPECT_NEAR(fittedOrder(points), 1.5, 1e-14);
}

TEST(FittedOrder, NeedsTwoSizesAndFiguresAboveZero) {
  const double nan = std::nan(""), inf = std::numeric_limits<double>::infinity();
  for (const std::vector<SizeAndError>& points : std::vector<std::vector<SizeAndError>>{{},
                                                                                        {{1, 1}},
                                                                                        {{3, 1}, {3, 2}},
                                                                                        {{1, 1}, {2, 0}},
                                                                                        {{0, 1}, {2, 1}},
                                                                                        {{1, -1}, {2, 1}},
                                                                                        {{1, nan}, {2, 1}},
                                                                                        {{1, 1}, {inf, 1}}}) {
    EXPECT_TRUE(std::isnan(fittedOrder(points)));
  }
}

}  // namespace fitted_order_test
}  // namespace palpate
