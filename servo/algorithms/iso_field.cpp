// SPDX-License-Identifier: Apache-2.0
#include "servo/algorithms/iso_field.hpp"

#include <algorithm>
#include <cmath>

#include "servo/algorithms/cell_walk.hpp"

namespace palpate {

int IsoField::searchSteps(const Vec3& way_W) const noexcept {
  const double wanted = std::ceil(way_W.norm() / (0.5 * voxel()));
  return static_cast<int>(std::clamp(wanted, 1.0, static_cast<double>(kMaxSearchSteps)));
}

std::optional<Entry> IsoField::firstEntry(const Probe& from, const Probe& to) const noexcept {
  const Vec3 from_L = sampler_.toIndex(from.p_W);
  const Vec3 to_L = sampler_.toIndex(to.p_W);
  // Most lines of a tool in free space end here. The highest density of a trilinear cell is at one of its corners.
  if (sampler_.highestAround(from_L, to_L) <= isovalue_) return std::nullopt;
  const Vec3 way_W = to.p_W - from.p_W;
  CellWalk walk(from_L, to_L, sampler_.lastIndex());
  Probe before = from;
  for (double t = walk.next();; t = walk.next()) {
    const Probe here = t < 1 ? probe(from.p_W + way_W * t) : to;
    if (auto entry = entryInCell(before, here)) return entry;
    if (t >= 1) return std::nullopt;
    before = here;
  }
}

// The first entry between two points of one cell. Four values determine the cubic. If its Bernstein coefficients are
// all below the isovalue, so is the cubic; otherwise its maximum decides.
std::optional<Entry> IsoField::entryInCell(const Probe& before, const Probe& after) const noexcept {
  const bool cubic = std::isfinite(before.density) && std::isfinite(after.density) && before.side != Side::kUnknown &&
                     after.side != Side::kUnknown;
  if (!cubic) {
    if (before.side == Side::kOutside && after.side == Side::kInside) return refined(before, after);
    return std::nullopt;
  }
  const Vec3 way_W = after.p_W - before.p_W;
  const Probe points[] = {before, probe(before.p_W + way_W / 3), probe(before.p_W + way_W * (2.0 / 3)), after};
  for (int i = 0; i < 3; ++i) {
    if (points[i].side == Side::kOutside && points[i + 1].side == Side::kInside) {
      return refined(points[i], points[i + 1]);
    }
  }
  if (before.side != Side::kOutside)
    return std::nullopt;  // the line is inside, or leaves the object and does not enter it again
  const double f0 = points[0].density - isovalue_;
  const double f1 = points[1].density - isovalue_;
  const double f2 = points[2].density - isovalue_;
  const double f3 = points[3].density - isovalue_;
  const double b1 = (-5 * f0 + 18 * f1 - 9 * f2 + 2 * f3) / 6;
  const double b2 = (2 * f0 - 9 * f1 + 18 * f2 - 5 * f3) / 6;
  if (b1 <= 0 && b2 <= 0) return std::nullopt;
  // The derivative is the quadratic with the Bernstein coefficients p, q, r (times 3). s is its root at the maximum.
  const double p = b1 - f0;
  const double q = b2 - b1;
  const double r = f3 - b2;
  const double discriminant = q * q - p * r;
  if (!(discriminant > 0)) return std::nullopt;
  const double s = p / (p - q + std::sqrt(discriminant));
  if (!(s > 0 && s < 1)) return std::nullopt;
  const Probe peak = probe(before.p_W + way_W * s);
  if (peak.side != Side::kInside) return std::nullopt;
  return refined(points[std::min(2, static_cast<int>(3 * s))], peak);
}

std::optional<Entry> IsoField::firstExit(const Probe& inside, const Vec3& to_W) const noexcept {
  const Vec3 way_W = to_W - inside.p_W;
  const int steps = searchSteps(way_W);
  Probe before = inside;
  for (int i = 1; i <= steps; ++i) {
    const Probe here = probe(inside.p_W + way_W * (static_cast<double>(i) / steps));
    if (here.side == Side::kUnknown) return std::nullopt;
    if (here.side == Side::kOutside) return refined(here, before);
    before = here;
  }
  return std::nullopt;
}

std::optional<Entry> IsoField::nearestExit(const Probe& inside) const noexcept {
  std::optional<Entry> nearest;
  if (inside.side != Side::kInside) return nearest;
  double nearest_m = kLongestWayOut * voxel();
  const auto look = [&](const Vec3& direction_W) {
    const auto way_out = firstExit(inside, inside.p_W + direction_W * nearest_m);
    if (!way_out) return;
    nearest = way_out;
    nearest_m = (way_out->p_W - inside.p_W).norm();
  };
  const Vec3 gradient_W = sampler_.at(inside.p_W).gradient_W;
  if (gradient_W.squaredNorm() > 0 && gradient_W.allFinite()) look(-gradient_W.normalized());
  for (int axis = 0; axis < 3; ++axis) {
    look(sampler_.faceNormal(axis, false));
    look(sampler_.faceNormal(axis, true));
  }
  return nearest;
}

bool IsoField::inAirBehind(const Vec3& on_plane_W, const Vec3& normal_W, const Probe& hip) const noexcept {
  if (hip.side != Side::kOutside) return false;
  const Probe start = probe(inFrontOf(sampler_, on_plane_W, normal_W));
  return start.side == Side::kOutside && !firstEntry(start, hip);
}

// Moves a probe beyond the volume along the line onto the face where the line enters the volume. That is the face that
// it passes last.
CutFace IsoField::clipToBox(Probe& outside, const Probe& inside) const noexcept {
  const Vec3 a_L = sampler_.toIndex(outside.p_W);
  const Vec3 b_L = sampler_.toIndex(inside.p_W);
  CutFace face;
  double t_last = 0;
  for (int axis = 0; axis < 3; ++axis) {
    const double last = sampler_.lastIndex()[axis];
    const bool high = a_L[axis] > last;
    if (!high && a_L[axis] >= 0) continue;
    const double t = ((high ? last : 0.0) - a_L[axis]) / (b_L[axis] - a_L[axis]);
    if (t >= t_last) {
      t_last = t;
      face = {axis, high};
    }
  }
  outside = probe(clampToBox(outside.p_W + (inside.p_W - outside.p_W) * t_last));
  return face;
}

// Regula falsi with halved weights (the Illinois rule). It converges for every continuous density.
Entry IsoField::refined(Probe outside, Probe inside) const noexcept {
  Entry entry;
  entry.direction_W = (inside.p_W - outside.p_W).normalized();
  if (std::isinf(outside.density)) {
    const CutFace face = clipToBox(outside, inside);
    if (outside.side != Side::kOutside) {
      entry.p_W = outside.p_W;
      entry.face = face;
      return entry;
    }
  }
  double f_out = outside.density - isovalue_;  // <= 0
  double f_in = inside.density - isovalue_;    // > 0
  const double close = 1e-4 * std::max(f_in, -f_out);
  int last_moved = 0;
  for (int i = 0; i < kMaxRefineSteps; ++i) {
    const double share = f_out / (f_out - f_in);
    entry.p_W = outside.p_W + (inside.p_W - outside.p_W) * (std::isfinite(share) ? share : 0.5);  // broken samples
    const Probe middle = probe(entry.p_W);
    const double f = middle.density - isovalue_;
    if (std::abs(f) <= close || middle.side == Side::kUnknown) break;
    const bool is_in = middle.side == Side::kInside;
    (is_in ? inside : outside) = middle;
    (is_in ? f_in : f_out) = f;
    const int moved = is_in ? 1 : -1;
    if (moved == last_moved) (is_in ? f_out : f_in) *= 0.5;
    last_moved = moved;
  }
  return entry;
}

Vec3 IsoField::clampToBox(const Vec3& p_W) const noexcept {
  return sampler_.toWorld(sampler_.toIndex(p_W).cwiseMax(Vec3::Zero()).cwiseMin(sampler_.lastIndex()));
}

}  // namespace palpate
