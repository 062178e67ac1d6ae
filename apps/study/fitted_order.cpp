// SPDX-License-Identifier: Apache-2.0
#include "apps/study/fitted_order.hpp"

#include <cmath>
#include <limits>

namespace palpate {
namespace {

constexpr double kNoOrder = std::numeric_limits<double>::quiet_NaN();

bool hasLogarithm(double value) {
  return std::isfinite(value) && value > 0;
}

}  // namespace

double fittedOrder(std::span<const SizeAndError> points) {
  double mean_x = 0, mean_y = 0;
  for (const auto& [size, error] : points) {
    if (!hasLogarithm(size) || !hasLogarithm(error)) return kNoOrder;
    mean_x += std::log(size) / static_cast<double>(points.size());
    mean_y += std::log(error) / static_cast<double>(points.size());
  }
  double xx = 0, xy = 0;
  for (const auto& [size, error] : points) {
    const double x = std::log(size) - mean_x;
    xx += x * x;
    xy += x * (std::log(error) - mean_y);
  }
  constexpr double kSame = 1e-18;  // of rounding alone
  return xx > kSame ? xy / xx : kNoOrder;
}

}  // namespace palpate
