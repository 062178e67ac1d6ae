// SPDX-License-Identifier: Apache-2.0
#include "apps/render/fit_camera.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <numbers>

#include "apps/render/asked_style.hpp"

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

// Kept is where normal . p + offset is not below 0, for a point p of the lattice [voxel].
struct LatticePlane {
  Vec3 normal;
  double offset;
};

std::vector<LatticePlane> onLattice(std::span<const ViewPlane> clips, const Lattice& lattice) {
  std::vector<LatticePlane> planes;
  for (const ViewPlane& clip : clips) {
    planes.push_back({(lattice.R_WL.transpose() * clip.normal_W).cwiseProduct(lattice.spacing_m),
                      clip.normal_W.dot(lattice.origin_W) - clip.offset_m});
  }
  return planes;
}

bool isBehindOne(const VoxelBox& box, std::span<const LatticePlane> planes) {
  const Vec3 middle = (box.first + box.last).cast<double>() / 2, half = (box.last - box.first).cast<double>() / 2;
  return std::any_of(planes.begin(), planes.end(), [&](const LatticePlane& plane) {
    return plane.normal.dot(middle) + plane.normal.cwiseAbs().dot(half) + plane.offset < 0;
  });
}

// The box around the cells of a row of bricks along i that hold some of the object in front of the planes.
VoxelBox objectInRow(std::span<const layout::BrickBounds> bounds, const BrickGrid& grid, std::uint32_t first,
                     float isovalue, std::span<const LatticePlane> planes) {
  VoxelBox row;
  for (std::uint32_t brick = first; brick < first + static_cast<std::uint32_t>(grid.counts().x()); ++brick) {
    if (!(bounds[brick].highest > isovalue)) continue;
    VoxelBox cells = grid.box(brick);
    // The cells that begin in a brick end at the first voxels of the next one.
    cells.last = (cells.last + Vec3i::Ones()).cwiseMin(grid.size - Vec3i::Ones());
    if (isBehindOne(cells, planes)) continue;
    row = row.empty() ? cells : hull(row, cells);
  }
  return row;
}

// The corners of the convex hull of points, by Andrew's monotone chain. Nothing is rounded.
std::vector<Eigen::Vector2i> hullCorners(std::vector<Eigen::Vector2i> points) {
  std::sort(points.begin(), points.end(),
            [](const auto& a, const auto& b) { return a.x() != b.x() ? a.x() < b.x() : a.y() < b.y(); });
  points.erase(std::unique(points.begin(), points.end()), points.end());
  if (points.size() < 3) return points;
  const auto turnsLeft = [](const Eigen::Vector2i& a, const Eigen::Vector2i& b, const Eigen::Vector2i& c) {
    const Eigen::Vector2<std::int64_t> ab = (b - a).cast<std::int64_t>(), ac = (c - a).cast<std::int64_t>();
    return ab.x() * ac.y() - ab.y() * ac.x() > 0;
  };
  std::vector<Eigen::Vector2i> corners;
  for (int side = 0; side < 2; ++side) {  // the lower one, and back along the upper one
    const std::size_t begin = corners.size();
    for (const Eigen::Vector2i& point : points) {
      while (corners.size() >= begin + 2 && !turnsLeft(corners[corners.size() - 2], corners.back(), point))
        corners.pop_back();
      corners.push_back(point);
    }
    corners.pop_back();  // where the other side begins
    std::reverse(points.begin(), points.end());
  }
  return corners;
}

// The corners of boxes that are all of one layer of bricks along k.
void addLayer(std::span<const VoxelBox> rows, const Lattice& lattice, std::vector<Vec3>& points_W) {
  if (rows.empty()) return;
  std::vector<Eigen::Vector2i> points;
  for (const VoxelBox& row : rows) {
    for (const int i : {row.first.x(), row.last.x()}) {
      for (const int j : {row.first.y(), row.last.y()}) points.emplace_back(i, j);
    }
  }
  const std::vector<Eigen::Vector2i> corners = hullCorners(std::move(points));
  for (const int k : {rows.front().first.z(), rows.front().last.z()}) {
    for (const Eigen::Vector2i& corner : corners) points_W.push_back(lattice.toWorld(Vec3(corner.x(), corner.y(), k)));
  }
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

SeenExtent wholeExtent(const BrickGrid& grid, const Lattice& lattice, std::span<const ViewPlane> clips) {
  SeenExtent extent{Vec3::Zero(), clippedCorners(lattice, grid.size, clips)};
  Vec3 low = Vec3::Constant(std::numeric_limits<double>::infinity()), high = -low;  // [voxel]
  for (const Vec3& point_W : extent.points_W) {
    low = low.cwiseMin(lattice.toIndex(point_W));
    high = high.cwiseMax(lattice.toIndex(point_W));
  }
  extent.middle_W = lattice.toWorld((low + high) / 2);
  return extent;
}

SeenExtent objectExtent(std::span<const layout::BrickBounds> bounds, const BrickGrid& grid, const Lattice& lattice,
                        float isovalue, std::span<const ViewPlane> clips) {
  SeenExtent extent;
  VoxelBox object;
  const std::vector<LatticePlane> planes = onLattice(clips, lattice);
  for (int k = 0; k < grid.counts().z(); ++k) {
    std::vector<VoxelBox> rows;
    for (int j = 0; j < grid.counts().y(); ++j) {
      const VoxelBox row = objectInRow(bounds, grid, grid.index({0, j, k}), isovalue, planes);
      if (row.empty()) continue;
      rows.push_back(row);
      object = object.empty() ? row : hull(object, row);
    }
    addLayer(rows, lattice, extent.points_W);
  }
  if (object.empty()) return wholeExtent(grid, lattice, clips);
  extent.middle_W = lattice.toWorld((object.first + object.last).cast<double>() / 2);
  return extent;
}

Vec3 targetOf(const RenderRequest& request, const SeenExtent& extent) {
  return request.target_W.value_or(extent.middle_W);
}

double fittingDistance(const RenderRequest& request, const SeenExtent& extent, const std::function<void()>& between) {
  const double tan_up = kFilledShare * std::tan(request.fov_rad / 2);
  const double tan_right = tan_up * request.width / request.height;
  double distance_m = 0;
  for (int frame = 0; frame < request.frames; ++frame) {
    if (between) between();
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
