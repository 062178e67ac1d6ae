// SPDX-License-Identifier: Apache-2.0
#include "engine/field/trilinear_cell.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace palpate {
namespace {

double between(double first, double last, double share) noexcept {
  return first * (1 - share) + last * share;
}

// How far a point of the cell may go in a direction before it leaves the cell.
double wayWithin(const Vec3& p, const Vec3& direction) {
  double way = std::numeric_limits<double>::infinity();
  for (int axis = 0; axis < 3; ++axis) {
    if (direction[axis] > 0) way = std::min(way, (1 - p[axis]) / direction[axis]);
    if (direction[axis] < 0) way = std::min(way, -p[axis] / direction[axis]);
  }
  return way;
}

// The field's zero between two points of different sign, to 1e-14 of the larger value. `from` has the sign of
// `excess_from`, `to` has the other one.
Vec3 zeroBetween(const TrilinearCell& field, Vec3 from, double excess_from, Vec3 to, double excess_to) {
  // The Illinois method: a secant, which halves the value at an end that has stayed twice.
  constexpr int kMostSteps = 60;
  const double near_enough = 1e-14 * std::max(std::abs(excess_from), std::abs(excess_to));
  int stayed = 0;
  Vec3 last = from;
  for (int step = 0; step < kMostSteps; ++step) {
    const Vec3 between = from + excess_from / (excess_from - excess_to) * (to - from);
    const double value = field.at(between);
    last = between;
    if (std::abs(value) <= near_enough) break;
    if ((value > 0) == (excess_to > 0)) {
      to = between;
      excess_to = value;
      if (stayed == 1) excess_from /= 2;
      stayed = 1;
    } else {
      from = between;
      excess_from = value;
      if (stayed == -1) excess_to /= 2;
      stayed = -1;
    }
  }
  return last;
}

}  // namespace

double TrilinearCell::at(const Vec3& p) const noexcept {
  const auto line = [&](std::size_t first) { return between(excess[first], excess[first + 1], p.x()); };
  return between(between(line(0), line(2), p.y()), between(line(4), line(6), p.y()), p.z());
}

Vec3 TrilinearCell::gradient(const Vec3& p) const noexcept {
  Vec3 gradient;
  for (int axis = 0; axis < 3; ++axis) {
    Vec3 low = p, high = p;
    low[axis] = 0;
    high[axis] = 1;
    gradient[axis] = at(high) - at(low);
  }
  return gradient;
}

std::optional<Vec3> TrilinearCell::surfaceFrom(const Vec3& p, const Vec3& outward) const {
  constexpr int kParts = 8;
  const double here = at(p);
  if (here == 0) return p;
  const Vec3 direction = here > 0 ? outward : Vec3(-outward);
  const double way = wayWithin(p, direction);
  if (!(way < std::numeric_limits<double>::infinity())) return std::nullopt;  // no direction
  Vec3 before = p;
  double before_excess = here;
  for (int part = 1; part <= kParts; ++part) {
    const Vec3 next = p + way * part / kParts * direction;
    const double next_excess = at(next);
    if ((next_excess > 0) != (here > 0)) {
      return zeroBetween(*this, before, before_excess, next, next_excess);
    }
    before = next;
    before_excess = next_excess;
  }
  return std::nullopt;
}

TrilinearCell trilinearCell(const SurfaceCell& cell, float isovalue) {
  TrilinearCell field;
  for (std::size_t corner = 0; corner < 8; ++corner)
    field.excess[corner] = static_cast<double>(cell.densities[corner]) - isovalue;
  return field;
}

}  // namespace palpate
