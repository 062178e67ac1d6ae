// SPDX-License-Identifier: Apache-2.0
#include "servo/algorithms/iso_field.hpp"

#include <algorithm>
#include <cmath>

namespace palpate {

int IsoField::searchSteps(const Vec3& way_W) const noexcept {
  const double wanted = std::ceil(way_W.norm() / (0.5 * voxel()));
  return static_cast<int>(std::clamp(wanted, 1.0, static_cast<double>(kMaxSearchSteps)));
}

std::optional<Entry> IsoField::firstEntry(const Probe& from, const Probe& to) const noexcept {
  const Vec3 way_W = to.p_W - from.p_W;
  const int steps = searchSteps(way_W);
  Probe before = from;
  for (int i = 1; i <= steps; ++i) {
    const Probe here = i == steps ? to : probe(from.p_W + way_W * (static_cast<double>(i) / steps));
    if (before.side == Side::kOutside && here.side == Side::kInside) return refined(before, here);
    before = here;
  }
  return std::nullopt;
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

// Moves a probe beyond the volume along the line onto the face where the line comes in; the face that it passes last.
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

// Regula falsi with halved weights (Illinois), which converges for every continuous density.
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
  entry.p_W = outside.p_W;
  int last_moved = 0;
  for (int i = 0; i < kMaxRefineSteps; ++i) {
    entry.p_W = outside.p_W + (inside.p_W - outside.p_W) * (f_out / (f_out - f_in));
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
