// SPDX-License-Identifier: Apache-2.0
#include "servo/stability/late_feedback.hpp"

#include <algorithm>
#include <cmath>
#include <complex>

namespace palpate {
namespace {

using Complex = std::complex<double>;

// A polynomial in y = 1 - cos(w), the lowest power first; y goes from 0 at z = 1 to 2 at z = -1.
using Powers = std::vector<double>;
constexpr double kEnd = 2;

double angleAt(double y) {
  return 2 * std::asin(std::sqrt(y / kEnd));
}

// zeta at z = exp(i w), without the cancellation of z - 1.
Complex zetaAt(double y) {
  return {-y, std::sqrt(y * (kEnd - y))};
}

double valueOf(const Powers& p, double y) {
  double value = 0;
  for (auto power = p.rbegin(); power != p.rend(); ++power) value = value * y + *power;
  return value;
}

Powers product(const Powers& a, const Powers& b) {
  Powers c(a.size() + b.size() - 1, 0);
  for (std::size_t i = 0; i < a.size(); ++i)
    for (std::size_t k = 0; k < b.size(); ++k) c[i + k] += a[i] * b[k];
  return c;
}

// |factor|^2 on the circle, where |zeta|^2 = 2 y, Re zeta = -y and Re zeta^2 = 2 y^2 - 2 y.
Powers squared(const LoopFactor& f) {
  return {f.constant * f.constant, 2 * f.linear * (f.linear - f.constant) - 4 * f.constant * f.square,
          4 * f.square * (f.square + f.constant - f.linear)};
}

Powers squared(const std::vector<LoopFactor>& factors) {
  Powers all = {1};
  for (const LoopFactor& one : factors) all = product(all, squared(one));
  return all;
}

Complex valueAt(const std::vector<LoopFactor>& factors, const Complex& zeta) {
  Complex value = 1;
  for (const LoopFactor& one : factors) value *= one.constant + zeta * (one.linear + zeta * one.square);
  return value;
}

// Where the sign changes in (0, kEnd): between neighbouring extrema, which are where that of the derivative does.
std::vector<double> signChanges(Powers p) {
  while (!p.empty() && p.back() == 0) p.pop_back();
  if (p.size() < 2) return {};
  Powers slope;
  for (std::size_t i = 1; i < p.size(); ++i) slope.push_back(static_cast<double>(i) * p[i]);
  std::vector<double> ends = signChanges(slope);
  ends.insert(ends.begin(), 0);
  ends.push_back(kEnd);
  std::vector<double> changes;
  for (std::size_t i = 0; i + 1 < ends.size(); ++i) {
    double low = ends[i], high = ends[i + 1];
    const bool is_positive = valueOf(p, low) > 0;
    if ((valueOf(p, high) > 0) == is_positive) continue;
    for (double middle = (low + high) / 2; middle > low && middle < high; middle = (low + high) / 2)
      ((valueOf(p, middle) > 0) == is_positive ? low : high) = middle;
    if (low > 0 && high < kEnd) changes.push_back(high);
  }
  return changes;
}

// The argument of zeta - root on the half circle, but for a constant: continuous in y. Seen from a root outside, the
// circle does not go around.
double turn(const Complex& root, double y) {
  const Complex z_of_root = 1.0 + root, distance = zetaAt(y) - root;
  const double angle = angleAt(y);
  if (std::norm(z_of_root) <= 1) return angle + std::arg(distance * std::polar(1.0, -angle));  // of 1 - root / z
  return std::arg(-distance / z_of_root);                                                      // of 1 - z / root
}

// Of all factors: the roots of each, by the formula that does not cancel.
double turn(const std::vector<LoopFactor>& factors, double y) {
  double sum = 0;
  for (const LoopFactor& f : factors) {
    if (f.square != 0) {
      const Complex root = std::sqrt(Complex(f.linear * f.linear - 4 * f.constant * f.square));
      const Complex twice = -(f.linear + (f.linear < 0 ? -root : root));
      const Complex first = twice / (2 * f.square);
      sum += turn(first, y) + turn(twice == 0.0 ? first : 2 * f.constant / twice, y);
    } else if (f.linear != 0) {
      sum += turn(-f.constant / f.linear, y);
    }
  }
  return sum;
}

int degreeOf(const std::vector<LoopFactor>& factors) {
  int degree = 0;
  for (const LoopFactor& f : factors) degree += f.square != 0 ? 2 : f.linear != 0 ? 1 : 0;
  return degree;
}

bool isZeroAtOne(const LateFeedback& loop) {
  return valueAt(loop.open, 0).real() + valueAt(loop.feedback, 0).real() == 0;
}

}  // namespace

int rootsInside(const LateFeedback& loop) {
  Powers difference = squared(loop.open);  // |A|^2 - |C|^2
  const Powers of_feedback = squared(loop.feedback);
  difference.resize(std::max(difference.size(), of_feedback.size()), 0);
  for (std::size_t i = 0; i < of_feedback.size(); ++i) difference[i] -= of_feedback[i];

  // At a border both terms are of one size; their angle there, from z^d A to C.
  const auto angleBetween = [&](double y) {
    const Complex zeta = zetaAt(y);
    const double angle = std::arg(valueAt(loop.feedback, zeta) / valueAt(loop.open, zeta));
    return std::remainder(angle - loop.delay_ticks * angleAt(y), 2 * M_PI);
  };

  double grown = 0, from = 0, ahead = 0;  // ahead: of f, at `from`, beyond z^d A, half of the angle between
  const auto addArc = [&](double to, double next_ahead) {
    if (valueOf(difference, (from + to) / 2) > 0) {
      grown += loop.delay_ticks * (angleAt(to) - angleAt(from)) + turn(loop.open, to) - turn(loop.open, from) +
               next_ahead - ahead;
    } else {
      grown += turn(loop.feedback, to) - turn(loop.feedback, from) - next_ahead + ahead;
    }
    from = to;
    ahead = next_ahead;
  };
  for (const double border : signChanges(difference)) addArc(border, angleBetween(border) / 2);
  addArc(kEnd, 0);  // at both ends of the half circle all is real
  return static_cast<int>(std::lround(grown / M_PI));
}

bool allInside(const LateFeedback& loop) {
  return !isZeroAtOne(loop) && rootsInside(loop) == loop.delay_ticks + degreeOf(loop.open);
}

}  // namespace palpate
