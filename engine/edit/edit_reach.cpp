// SPDX-License-Identifier: Apache-2.0
#include "engine/edit/edit_reach.hpp"

#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>

#include "shaders/kernel_text.hpp"

namespace palpate {
namespace {

// Kernels and this file measure lengths in float. These margins, shares of a voxel and of the lengths involved, exceed
// the rounding errors of both together.
constexpr double kMarginVoxels = 0.01;
constexpr double kMarginRelative = 1e-5;

Vec3 pointA(const layout::EditCommand& c) {
  return {c.a_x, c.a_y, c.a_z};
}
Vec3 pointAB(const layout::EditCommand& c) {
  return {c.ab_x, c.ab_y, c.ab_z};
}
Vec3 normal(const layout::EditCommand& c) {
  return {c.n_x, c.n_y, c.n_z};
}
Vec3 origin(const layout::EditCommand& c) {
  return Vec3i(c.origin_x, c.origin_y, c.origin_z).cast<double>();
}

// A box of voxel centres in a command's local frame [m].
struct LocalBox {
  Vec3 middle, half;
  double half_diagonal;

  LocalBox(const layout::EditCommand& c, const BrickGrid& grid, const Vec3i& first, const Vec3i& last)
      : middle(((first + last).cast<double>() / 2 - origin(c)).cwiseProduct(grid.spacing_m)),
        half((last - first).cast<double>().cwiseProduct(grid.spacing_m) / 2),
        half_diagonal(half.norm()) {}
};

// Computed by the kernels' text (shaders/edit.math.glsl), which takes four points at once. `p` is in the local frame.
double distanceFrom(const layout::EditCommand& c, const Vec3& p) {
  const Eigen::Vector3f at = p.cast<float>();
  return static_cast<double>(kernel_text::strokeDistance(c, kernel_text::vec4(at.x()), at.y(), at.z())[0]);
}
double heightAt(const layout::EditCommand& c, const Vec3& p) {
  const Eigen::Vector3f at = p.cast<float>();
  return static_cast<double>(kernel_text::planeHeight(c, kernel_text::vec4(at.x()), at.y(), at.z())[0]);
}

// `distance`: from the stroke [m]. `depth`: under the new surface [m].
float fadeShare(const layout::EditCommand& c, double distance) {
  return kernel_text::fadeShare(c, kernel_text::vec4(static_cast<float>(distance)))[0];
}
float filledRamp(const layout::EditCommand& c, double depth) {
  return kernel_text::filledRamp(c, kernel_text::vec4(static_cast<float>(depth)))[0];
}
float clearedRamp(const layout::EditCommand& c, double depth) {
  return kernel_text::clearedRamp(c, kernel_text::vec4(static_cast<float>(depth)))[0];
}

double marginLength(const layout::EditCommand& c, const BrickGrid& grid) {
  const double length = static_cast<double>(c.radius) + pointA(c).norm() + pointAB(c).norm();
  return kMarginVoxels * grid.spacing_m.minCoeff() + kMarginRelative * length;
}

// The lowest and highest height of a box above the command's plane [m].
std::pair<double, double> heights(const layout::EditCommand& c, const LocalBox& box) {
  const double middle = heightAt(c, box.middle);
  const double spread = normal(c).cwiseAbs().dot(box.half);
  return {middle - spread, middle + spread};
}

VoxelBox cutToDomain(const BrickGrid& grid, const Vec3& low_L, const Vec3& high_L) {
  const Vec3 last = (grid.size - Vec3i::Ones()).cast<double>();
  // Clamped in double first: the place may be out of the range of int.
  const Vec3 first_L = low_L.array().floor().matrix().cwiseMax(-1).cwiseMin(last + Vec3::Ones());
  const Vec3 last_L = high_L.array().ceil().matrix().cwiseMax(-1).cwiseMin(last + Vec3::Ones());
  VoxelBox box{first_L.cast<int>().cwiseMax(0), last_L.cast<int>().cwiseMin(grid.size - Vec3i::Ones())};
  return box;
}

// The box of all voxels within `reach` of the stroke from `a` to `b` (local frame, [m]).
VoxelBox strokeBox(const layout::EditCommand& c, const BrickGrid& grid, const Vec3& a, const Vec3& b, double reach) {
  const Vec3 low = a.cwiseMin(b) - Vec3::Constant(reach);
  const Vec3 high = a.cwiseMax(b) + Vec3::Constant(reach);
  return cutToDomain(grid, low.cwiseQuotient(grid.spacing_m) + origin(c),
                     high.cwiseQuotient(grid.spacing_m) + origin(c));
}

VoxelBox stampBox(const layout::EditCommand& c, const BrickGrid& grid) {
  Mat3 to_stamp;
  to_stamp << c.m_xx, c.m_xy, c.m_xz, c.m_yx, c.m_yy, c.m_yz, c.m_zx, c.m_zy, c.m_zz;
  const Vec3 t(c.m_xt, c.m_yt, c.m_zt);
  const Mat3 back = to_stamp.inverse();
  Vec3 low = Vec3::Constant(std::numeric_limits<double>::infinity());
  Vec3 high = -low;
  const Vec3 last = Eigen::Vector<layout::uint, 3>(c.stamp_x - 1, c.stamp_y - 1, c.stamp_z - 1).cast<double>();
  for (int corner = 0; corner < 8; ++corner) {
    const Vec3 at = Vec3(corner & 1, corner >> 1 & 1, corner >> 2).cwiseProduct(last);
    const Vec3 p_L = (back * (at - t)).cwiseQuotient(grid.spacing_m) + origin(c);
    low = low.cwiseMin(p_L);
    high = high.cwiseMax(p_L);
  }
  return cutToDomain(grid, low, high);
}

template <typename Test>
void appendBricks(const BrickGrid& grid, const VoxelBox& box, std::vector<std::uint32_t>& bricks, const Test& test) {
  grid.forEachIn(box, [&](const Vec3i& brick) {
    if (test(brick)) bricks.push_back(grid.index(brick));
  });
}

LocalBox boxOfBrick(const layout::EditCommand& c, const BrickGrid& grid, const Vec3i& brick) {
  const Vec3i first = brick * kBrickSize;
  const Vec3i last = (first + Vec3i::Constant(kBrickSize - 1)).cwiseMin(grid.size - Vec3i::Ones());
  return {c, grid, first, last};
}

// A long stroke is cut into pieces, so that their boxes fit it closely.
void appendStroke(const layout::EditCommand& c, const BrickGrid& grid, std::vector<std::uint32_t>& bricks) {
  const double reach = static_cast<double>(c.reach) + marginLength(c, grid);
  const Vec3 ab = pointAB(c);
  const double piece_m = std::max(4 * reach, 4.0 * kBrickSize * grid.spacing_m.maxCoeff());
  const int pieces = std::max(1, static_cast<int>(std::ceil(ab.norm() / piece_m)));
  for (int i = 0; i < pieces; ++i) {
    const Vec3 from = pointA(c) + ab * (static_cast<double>(i) / pieces);
    const Vec3 to = pointA(c) + ab * (static_cast<double>(i + 1) / pieces);
    appendBricks(grid, strokeBox(c, grid, from, to, reach), bricks, [&](const Vec3i& brick) {
      const LocalBox box = boxOfBrick(c, grid, brick);
      return distanceFrom(c, box.middle) <= reach + box.half_diagonal;
    });
  }
}

// Whether a command has the same, full effect on the whole brick. That holds if the ramp has ended and nothing fades at
// the brick's least depth. Ramp and fade are monotonic in the depth, in floats too.
bool isCore(const layout::EditCommand& c, const BrickGrid& grid, const LocalBox& box) {
  const double margin = marginLength(c, grid);
  if (c.kind == EDIT_CUT) {
    const double lowest = heights(c, box).first - margin;
    return lowest >= 0 && clearedRamp(c, lowest) <= c.background;
  }
  const double farthest = distanceFrom(c, box.middle) + box.half_diagonal + margin;
  const double depth = static_cast<double>(c.radius) - farthest;  // the least, under the capsule's surface
  if (depth < 0 || fadeShare(c, farthest) < 1) return false;
  switch (c.kind) {
    case EDIT_ADD:
      return filledRamp(c, depth) >= c.object;
    case EDIT_REMOVE:
      return clearedRamp(c, depth) <= c.background;
    case EDIT_PAINT:
      return true;
    case EDIT_FLATTEN: {
      const auto [low, high] = heights(c, box);
      return clearedRamp(c, low - margin) <= c.background || clearedRamp(c, high + margin) >= c.object;
    }
    default:
      return false;
  }
}

// Whether the command certainly leaves `density` as it is. A removal only lowers densities, down to the background; an
// addition only raises them, up to the object density. Nothing is certain for -0.
bool leavesAlone(const layout::EditCommand& c, float density) {
  const bool same_zero = std::bit_cast<std::uint32_t>(density + 0.0F) == std::bit_cast<std::uint32_t>(density);
  if (c.kind == EDIT_REMOVE || c.kind == EDIT_CUT || c.kind == EDIT_STAMP_REMOVE)
    return same_zero && density <= c.background;
  if (c.kind == EDIT_ADD || c.kind == EDIT_STAMP_ADD) return same_zero && density >= c.object;
  return false;
}

}  // namespace

std::vector<std::uint32_t> reachedBricks(const layout::EditCommand& c, const BrickGrid& grid) {
  std::vector<std::uint32_t> bricks;
  if (c.kind == EDIT_CUT) {
    const double reach = static_cast<double>(c.reach) + marginLength(c, grid);
    appendBricks(grid, {Vec3i::Zero(), grid.size - Vec3i::Ones()}, bricks,
                 [&](const Vec3i& brick) { return heights(c, boxOfBrick(c, grid, brick)).second >= -reach; });
  } else if (c.kind == EDIT_STAMP_ADD || c.kind == EDIT_STAMP_REMOVE) {
    appendBricks(grid, stampBox(c, grid), bricks, [](const Vec3i&) { return true; });
  } else {
    appendStroke(c, grid, bricks);
  }
  sortUnique(bricks);
  return bricks;
}

VoxelBox reachedBox(const layout::EditCommand& c, const BrickGrid& grid) {
  if (c.kind == EDIT_CUT) return {Vec3i::Zero(), grid.size - Vec3i::Ones()};
  if (c.kind == EDIT_STAMP_ADD || c.kind == EDIT_STAMP_REMOVE) return stampBox(c, grid);
  return strokeBox(c, grid, pointA(c), pointA(c) + pointAB(c), static_cast<double>(c.reach) + marginLength(c, grid));
}

bool mayCross(const layout::EditCommand& c, const BrickGrid& grid, std::uint32_t index) {
  if (c.kind != EDIT_ADD && c.kind != EDIT_REMOVE && c.kind != EDIT_CUT) return true;
  const double margin = marginLength(c, grid);
  // If the isovalue's rounding hides the ramp over a margin's length, nothing is certain.
  if (static_cast<double>(c.slope) * margin < 1e-5 * std::abs(static_cast<double>(c.isovalue))) return true;
  const LocalBox box = boxOfBrick(c, grid, grid.brick(index));
  if (c.kind == EDIT_CUT) return heights(c, box).second >= -margin;
  return distanceFrom(c, box.middle) <= static_cast<double>(c.radius) + box.half_diagonal + margin;
}

std::optional<float> uniformResult(const layout::EditCommand& c, const BrickGrid& grid, std::uint32_t index,
                                   float density) {
  if (leavesAlone(c, density)) return density;
  const Vec3i brick = grid.brick(index);
  if (!isCore(c, grid, boxOfBrick(c, grid, brick))) return std::nullopt;
  // All voxels get the same density, so the first one is computed.
  const Vec3i voxel = brick * kBrickSize;
  const layout::EditScale scale = editScale(grid.spacing_m);
  const float px = kernel_text::placeAlong(voxel.x(), c.origin_x, scale.h_x);
  const float py = kernel_text::placeAlong(voxel.y(), c.origin_y, scale.h_y);
  const float pz = kernel_text::placeAlong(voxel.z(), c.origin_z, scale.h_z);
  return kernel_text::edited(c.kind, c, kernel_text::vec4(px), py, pz, kernel_text::vec4(density))[0];
}

}  // namespace palpate
