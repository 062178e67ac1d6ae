// SPDX-License-Identifier: Apache-2.0
#include "engine/reference/edited_density.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <optional>

namespace palpate::reference {
namespace {

using Triple = std::array<float, 3>;

// In docs/edits.md, max(x, y) and min(x, y) are x unless y is greater, or less. So are std::max, std::min and
// std::clamp.
float clampedShare(float x) {
  return std::clamp(x, 0.0F, 1.0F);
}
float finiteDensity(float density) {
  constexpr float kLargest = std::numeric_limits<float>::max();
  return std::clamp(density, -kLargest, kLargest);
}

Triple placeOf(const layout::EditCommand& c, const layout::EditScale& scale, const Vec3i& voxel) {
  return {static_cast<float>(voxel.x() - c.origin_x) * scale.h_x,
          static_cast<float>(voxel.y() - c.origin_y) * scale.h_y,
          static_cast<float>(voxel.z() - c.origin_z) * scale.h_z};
}

float distanceFromSegment(const layout::EditCommand& c, const Triple& p) {
  const Triple ab = {c.ab_x, c.ab_y, c.ab_z};
  const Triple q = {p[0] - c.a_x, p[1] - c.a_y, p[2] - c.a_z};
  Triple r = q;
  if (c.inv_ab2 > 0) {
    const float t = clampedShare((q[0] * ab[0] + (q[1] * ab[1] + q[2] * ab[2])) * c.inv_ab2);
    for (std::size_t axis = 0; axis < 3; ++axis) r[axis] = q[axis] - t * ab[axis];
  }
  return std::sqrt(r[0] * r[0] + r[1] * r[1] + r[2] * r[2]);
}

float heightAbovePlane(const layout::EditCommand& c, const Triple& p) {
  return c.n_x * p[0] + ((c.n_y * p[1] + c.n_z * p[2]) - c.n_d);
}

// w in docs/edits.md; 1 without a fade.
float fade(const layout::EditCommand& c, float d) {
  if (c.inv_fade == 0) return 1;
  const float s = clampedShare((c.radius - d) * c.inv_fade);
  return (s * s) * (3 - 2 * s);
}

float material(const layout::EditCommand& c, float f) {
  if (c.material_drop == 0) return 1;
  return 1 - c.material_drop * clampedShare((f - c.material_low) * c.material_inv_range);
}

float addTarget(const layout::EditCommand& c, float f, float depth) {
  return std::max(f, std::min(c.isovalue + c.slope * depth, c.object));
}
float removeTarget(const layout::EditCommand& c, float f, float depth) {
  return std::min(f, std::max(c.isovalue - c.slope * depth, c.background));
}
float planeTarget(const layout::EditCommand& c, float height) {
  return std::min(std::max(c.isovalue - c.slope * height, c.background), c.object);
}

float towards(float g, float f, float a) {
  if (a >= 1) return g;
  return a > 0 ? finiteDensity(f + a * (g - f)) : f;
}

// ---- Stamps.

// Along one axis of the stamp's lattice: the cell, and the share of the way through it.
struct CellPlace {
  std::size_t cell;
  float share;
};
std::optional<CellPlace> cellPlace(float at, layout::uint size) {
  if (!(at >= 0 && at <= static_cast<float>(size - 1))) return std::nullopt;
  const auto cell = std::min(static_cast<layout::uint>(std::floor(at)), size - 2);
  return CellPlace{cell, at - static_cast<float>(cell)};
}

float between(float low, float high, float t) {
  return low + t * (high - low);
}

// Nothing beyond the lattice.
std::optional<float> stampDistance(const layout::EditCommand& c, std::span<const float> stamps, const Triple& p) {
  const auto x = cellPlace(((c.m_xx * p[0] + c.m_xy * p[1]) + c.m_xz * p[2]) + c.m_xt, c.stamp_x);
  const auto y = cellPlace(((c.m_yx * p[0] + c.m_yy * p[1]) + c.m_yz * p[2]) + c.m_yt, c.stamp_y);
  const auto z = cellPlace(((c.m_zx * p[0] + c.m_zy * p[1]) + c.m_zz * p[2]) + c.m_zt, c.stamp_z);
  if (!x || !y || !z) return std::nullopt;
  std::array<float, 2> slices{};
  for (std::size_t dz = 0; dz < 2; ++dz) {
    std::array<float, 2> rows{};
    for (std::size_t dy = 0; dy < 2; ++dy) {
      const std::size_t row = ((z->cell + dz) * c.stamp_y + y->cell + dy) * c.stamp_x;
      const auto at = stamps.subspan(c.stamp_first + row + x->cell, 2);
      rows[dy] = between(at[0], at[1], x->share);
    }
    slices[dz] = between(rows[0], rows[1], y->share);
  }
  return between(slices[0], slices[1], z->share);
}

// ---- Kinds that read neighbours.

float smoothedDensity(const layout::EditScale& scale, float f, const Neighbours& around, float a) {
  const auto part = [&](std::size_t axis, float c) {
    return finiteDensity((around.before[axis] - f) + (around.after[axis] - f)) * c;
  };
  return finiteDensity(f + a * (part(0, scale.blur_x) + part(1, scale.blur_y) + part(2, scale.blur_z)));
}

// `sign`: 1 inflates, by the steepest rises; -1 deflates, by the steepest falls.
float inflatedDensity(const layout::EditScale& scale, float f, const Neighbours& around, float amount, float sign) {
  const Triple inv_h = {scale.inv_h_x, scale.inv_h_y, scale.inv_h_z};
  float farthest = f;  // the highest (lowest) neighbour; f itself if no neighbour is higher (lower)
  float square = 0;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    float steepest = 0;
    for (const float neighbour : {around.before[axis], around.after[axis]}) {
      if (sign * farthest < sign * neighbour) farthest = neighbour;
      steepest = std::max(steepest, sign * (neighbour - f) * inv_h[axis]);
    }
    square += steepest * steepest;
  }
  const float moved = f + sign * amount * finiteDensity(std::sqrt(square));
  return sign * farthest < sign * moved ? farthest : moved;
}

}  // namespace

bool readsNeighbours(const layout::EditCommand& c) noexcept {
  return c.kind == EDIT_SMOOTH || c.kind == EDIT_INFLATE || c.kind == EDIT_DEFLATE;
}

float editedDensity(const layout::EditCommand& c, const layout::EditScale& scale, std::span<const float> stamps,
                    const Vec3i& voxel, float f, const Neighbours& around) noexcept {
  const Triple p = placeOf(c, scale, voxel);
  if (c.kind == EDIT_CUT) {
    const float height = heightAbovePlane(c, p);
    return height >= -c.reach ? towards(removeTarget(c, f, height), f, c.strength) : f;
  }
  if (c.kind == EDIT_STAMP_ADD || c.kind == EDIT_STAMP_REMOVE) {
    const std::optional<float> d = stampDistance(c, stamps, p);
    if (!d || *d > c.reach) return f;
    return towards(c.kind == EDIT_STAMP_ADD ? addTarget(c, f, -*d) : removeTarget(c, f, -*d), f, c.strength);
  }
  const float d = distanceFromSegment(c, p);
  if (d > c.reach) return f;
  const float a = c.strength * fade(c, d);
  if (!(a > 0)) return f;
  switch (c.kind) {
    case EDIT_ADD:
      return towards(addTarget(c, f, c.radius - d), f, a);
    case EDIT_REMOVE:
      return towards(removeTarget(c, f, c.radius - d), f, a * material(c, f));
    case EDIT_PAINT:
      return towards(c.value, f, a);
    case EDIT_FLATTEN:
      return towards(planeTarget(c, heightAbovePlane(c, p)), f, a);
    case EDIT_SMOOTH:
      return smoothedDensity(scale, f, around, a);
    case EDIT_INFLATE:
      return inflatedDensity(scale, f, around, a * c.value, 1);
    default:
      return inflatedDensity(scale, f, around, a * c.value, -1);
  }
}

}  // namespace palpate::reference
