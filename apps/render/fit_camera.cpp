// SPDX-License-Identifier: Apache-2.0
#include "apps/render/fit_camera.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace palpate {
namespace {

// A point v from the target is v . from nearer to the camera than the target. It is in the picture if |v . right| is at
// most (distance - v . from) times the tangent of half the horizontal angle; up, the same.
double leastDistance(const SeenExtent& extent, const Vec3& target_W, const ViewAxes& axes, double tan_right,
                     double tan_up) {
  const Vec3 right_W = axes.up_W.cross(axes.from_W);
  double distance_m = 0;
  for (const Vec3& point_W : extent.points_W) {
    const Vec3 v = point_W - target_W;
    const double beside_m = std::max(std::abs(v.dot(right_W)) / tan_right, std::abs(v.dot(axes.up_W)) / tan_up);
    distance_m = std::max(distance_m, v.dot(axes.from_W) + beside_m);
  }
  return distance_m;
}

void addCorners(const VoxelBox& box, const Lattice& lattice, std::vector<Vec3>& points_W) {
  for (int corner = 0; corner < 8; ++corner) {
    const Vec3i voxel((corner & 1) == 0 ? box.first.x() : box.last.x(),
                      (corner & 2) == 0 ? box.first.y() : box.last.y(),
                      (corner & 4) == 0 ? box.first.z() : box.last.z());
    points_W.push_back(lattice.toWorld(voxel.cast<double>()));
  }
}

Vec3 middleOf(const VoxelBox& box, const Lattice& lattice) {
  return lattice.toWorld((box.first + box.last).cast<double>() / 2);
}

}  // namespace

// Up is how `from` moves as the elevation grows.
ViewAxes axesOf(const ViewAngles& angles) noexcept {
  const double sin_a = std::sin(angles.azimuth_rad), cos_a = std::cos(angles.azimuth_rad);
  const double sin_e = std::sin(angles.elevation_rad), cos_e = std::cos(angles.elevation_rad);
  return {{sin_a * cos_e, -cos_a * cos_e, sin_e}, {-sin_a * sin_e, cos_a * sin_e, cos_e}};
}

ViewAngles frameView(const RenderRequest& request, int frame) noexcept {
  return {request.view.azimuth_rad + 2 * std::numbers::pi * frame / request.frames, request.view.elevation_rad};
}

SeenExtent wholeExtent(const BrickGrid& grid, const Lattice& lattice) {
  const VoxelBox all{Vec3i::Zero(), grid.size - Vec3i::Ones()};
  SeenExtent extent{middleOf(all, lattice), {}};
  addCorners(all, lattice, extent.points_W);
  return extent;
}

SeenExtent objectExtent(std::span<const layout::BrickBounds> bounds, const BrickGrid& grid, const Lattice& lattice,
                        float isovalue) {
  SeenExtent extent;
  VoxelBox object;
  const int row_bricks = grid.counts().x();
  for (std::uint32_t begin = 0; begin < bounds.size(); begin += static_cast<std::uint32_t>(row_bricks)) {
    VoxelBox row;
    for (std::uint32_t brick = begin; brick < begin + static_cast<std::uint32_t>(row_bricks); ++brick) {
      if (!(bounds[brick].highest > isovalue)) continue;
      VoxelBox cells = grid.box(brick);
      // The cells that begin in a brick end at the first voxels of the next one.
      cells.last = (cells.last + Vec3i::Ones()).cwiseMin(grid.size - Vec3i::Ones());
      row = row.empty() ? cells : hull(row, cells);
    }
    if (row.empty()) continue;
    addCorners(row, lattice, extent.points_W);
    object = object.empty() ? row : hull(object, row);
  }
  if (object.empty()) return wholeExtent(grid, lattice);
  extent.middle_W = middleOf(object, lattice);
  return extent;
}

Vec3 targetOf(const RenderRequest& request, const SeenExtent& extent) {
  return request.target_W.value_or(extent.middle_W);
}

double fittingDistance(const RenderRequest& request, const SeenExtent& extent) {
  const double tan_up = kFilledShare * std::tan(request.fov_rad / 2);
  const double tan_right = tan_up * request.width / request.height;
  double distance_m = 0;
  for (int frame = 0; frame < request.frames; ++frame) {
    const ViewAxes axes = axesOf(frameView(request, frame));
    distance_m = std::max(distance_m, leastDistance(extent, targetOf(request, extent), axes, tan_right, tan_up));
  }
  return distance_m;
}

Camera frameCamera(const RenderRequest& request, const Vec3& target_W, double distance_m, int frame) {
  const ViewAxes axes = axesOf(frameView(request, frame));
  return lookAt(target_W, axes.from_W, distance_m, axes.up_W, request.width, request.height,
                2 * std::atan(std::tan(request.fov_rad / 2) / request.zoom));
}

}  // namespace palpate
