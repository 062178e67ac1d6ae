// SPDX-License-Identifier: Apache-2.0
// engine/edit/edit_math.hpp: what an edit command does to one voxel, on the CPU: the twin of shaders/edit.math.glsl,
// edit.comp, edit_stamp.glsl and edit_stencil.comp. Every operation is in float, in the kernels' order, with
// comparisons for min and max, so that lavapipe agrees bit for bit. Planning evaluates it for constant bricks, the
// reference for whole volumes. Any thread.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <span>

#include "engine/edit/lower_edit.hpp"
#include "shaders/edit.layout.h"

namespace palpate::edit_math {

inline constexpr float kLargest = 3.4028234e38F;

inline float lesser(float a, float b) noexcept {
  return b < a ? b : a;
}
inline float greater(float a, float b) noexcept {
  return a < b ? b : a;
}
inline float finite(float value) noexcept {
  return lesser(greater(value, -kLargest), kLargest);
}

// Position of a voxel along the lattice's axes from the command's origin voxel [m].
struct Local {
  float x, y, z;
};
inline Local local(const layout::EditCommand& c, const EditScale& scale, int i, int j, int k) noexcept {
  return {static_cast<float>(i - c.origin_x) * scale.h[0], static_cast<float>(j - c.origin_y) * scale.h[1],
          static_cast<float>(k - c.origin_z) * scale.h[2]};
}

inline float strokeDistance(const layout::EditCommand& c, const Local& p) noexcept {
  const float qx = p.x - c.a_x;
  const float qy = p.y - c.a_y;
  const float qz = p.z - c.a_z;
  float rx = qx;
  float ry = qy;
  float rz = qz;
  if (c.inv_ab2 > 0) {
    const float across = qy * c.ab_y + qz * c.ab_z;
    const float t = lesser(greater((qx * c.ab_x + across) * c.inv_ab2, 0), 1);
    rx = qx - t * c.ab_x;
    ry = qy - t * c.ab_y;
    rz = qz - t * c.ab_z;
  }
  return std::sqrt((rx * rx + ry * ry) + rz * rz);
}

inline float planeHeight(const layout::EditCommand& c, const Local& p) noexcept {
  return c.n_x * p.x + ((c.n_y * p.y + c.n_z * p.z) - c.n_d);
}

inline float amountAt(const layout::EditCommand& c, float distance) noexcept {
  if (c.inv_fade == 0) return c.strength;
  const float s = lesser(greater((c.radius - distance) * c.inv_fade, 0), 1);
  return c.strength * ((s * s) * (3.0F - 2.0F * s));
}

inline float blend(float f, float target, float amount) noexcept {
  if (!(amount > 0)) return f;
  return amount >= 1 ? target : finite(f + amount * (target - f));
}

inline float filledTarget(const layout::EditCommand& c, float f, float depth) noexcept {
  return greater(f, lesser(c.isovalue + c.slope * depth, c.object));
}
inline float clearedTarget(const layout::EditCommand& c, float f, float depth) noexcept {
  return lesser(f, greater(c.isovalue - c.slope * depth, c.background));
}

inline float materialRate(const layout::EditCommand& c, float f) noexcept {
  const float share = lesser(greater((f - c.material_low) * c.material_inv_range, 0), 1);
  return 1.0F - c.material_drop * share;
}

inline float lerp(float a, float b, float t) noexcept {
  return a + t * (b - a);
}

// Signed distance from a stamp's surface, trilinearly interpolated; false outside the stamp's lattice.
inline bool stampDistance(const layout::EditCommand& c, std::span<const float> stamps, const Local& p,
                          float& distance) noexcept {
  const float u = ((c.m_xx * p.x + c.m_xy * p.y) + c.m_xz * p.z) + c.m_xt;
  const float v = ((c.m_yx * p.x + c.m_yy * p.y) + c.m_yz * p.z) + c.m_yt;
  const float w = ((c.m_zx * p.x + c.m_zy * p.y) + c.m_zz * p.z) + c.m_zt;
  const auto within = [](float at, unsigned n) { return at >= 0 && at <= static_cast<float>(n - 1); };
  if (!within(u, c.stamp_x) || !within(v, c.stamp_y) || !within(w, c.stamp_z)) return false;
  const unsigned x = std::min(static_cast<unsigned>(u), c.stamp_x - 2);
  const unsigned y = std::min(static_cast<unsigned>(v), c.stamp_y - 2);
  const unsigned z = std::min(static_cast<unsigned>(w), c.stamp_z - 2);
  const float fu = u - static_cast<float>(x);
  const float fv = v - static_cast<float>(y);
  const float fw = w - static_cast<float>(z);
  const std::size_t at = c.stamp_first + (std::size_t{z} * c.stamp_y + y) * c.stamp_x + x;
  const auto row = [&](std::size_t first) { return lerp(stamps[first], stamps[first + 1], fu); };
  const auto face = [&](std::size_t first) { return lerp(row(first), row(first + c.stamp_x), fv); };
  distance = lerp(face(at), face(at + std::size_t{c.stamp_x} * c.stamp_y), fw);
  return true;
}

// The new density of a voxel with density f, for a command that does not read neighbours.
inline float edited(const layout::EditCommand& c, std::span<const float> stamps, const Local& p, float f) noexcept {
  if (c.kind == EDIT_CUT) {
    const float height = planeHeight(c, p);
    return height >= -c.reach ? blend(f, clearedTarget(c, f, height), c.strength) : f;
  }
  if (c.kind == EDIT_STAMP_ADD || c.kind == EDIT_STAMP_REMOVE) {
    float distance = 0;
    if (!stampDistance(c, stamps, p, distance) || !(-distance >= -c.reach)) return f;
    return blend(f, c.kind == EDIT_STAMP_ADD ? filledTarget(c, f, -distance) : clearedTarget(c, f, -distance),
                 c.strength);
  }
  const float distance = strokeDistance(c, p);
  if (!(distance <= c.reach)) return f;
  const float depth = c.radius - distance;
  float amount = amountAt(c, distance);
  float target = c.value;
  if (c.kind == EDIT_ADD) target = filledTarget(c, f, depth);
  if (c.kind == EDIT_REMOVE) {
    target = clearedTarget(c, f, depth);
    if (c.material_drop > 0) amount = amount * materialRate(c, f);
  }
  if (c.kind == EDIT_FLATTEN) {
    target = lesser(greater(c.isovalue - c.slope * planeHeight(c, p), c.background), c.object);
  }
  return blend(f, target, amount);
}

// Densities of a voxel's six neighbours, by axis. A neighbour outside the domain has the voxel's own density.
struct Neighbours {
  std::array<float, 3> before, after;
};

// The new density for a command that reads neighbours (smooth, inflate, deflate).
inline float editedWithNeighbours(const layout::EditCommand& c, const EditScale& scale, const Local& p, float f,
                                  const Neighbours& n) noexcept {
  const float distance = strokeDistance(c, p);
  if (!(distance <= c.reach)) return f;
  const float amount = amountAt(c, distance);
  if (!(amount > 0)) return f;
  std::array<float, 3> part{};
  if (c.kind == EDIT_SMOOTH) {
    for (int a = 0; a < 3; ++a) part[a] = finite((n.before[a] - f) + (n.after[a] - f)) * scale.blur[a];
    return finite(f + amount * ((part[0] + part[1]) + part[2]));
  }
  // The steepest rise (inflate) or fall (deflate) along each axis. The result does not pass the highest or lowest
  // neighbour, so no new extreme arises.
  const float sign = c.kind == EDIT_INFLATE ? 1.0F : -1.0F;
  float highest = sign * f;
  for (int a = 0; a < 3; ++a) {
    const float top = greater(sign * n.before[a], sign * n.after[a]);
    highest = greater(highest, top);
    const float steep = greater(top - sign * f, 0) * scale.inv_h[a];
    part[a] = steep * steep;
  }
  const float steepness = lesser(std::sqrt((part[0] + part[1]) + part[2]), kLargest);
  const float moved = f + ((amount * c.value) * sign) * steepness;
  return highest < sign * moved ? sign * highest : moved;
}

[[nodiscard]] inline bool readsNeighbours(const layout::EditCommand& c) noexcept {
  return c.kind >= EDIT_SMOOTH;
}

}  // namespace palpate::edit_math
