// SPDX-License-Identifier: Apache-2.0
#include "apps/render/fit_camera.hpp"

#include <algorithm>
#include <array>
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

// What objectExtent() was asked.
struct Asked {
  std::span<const layout::BrickBounds> bounds;
  const BrickGrid& grid;
  float isovalue;
  std::vector<LatticePlane> planes;
};

// The cells that begin in a brick, where they hold some of the object in front of the planes; else an empty box.
VoxelBox objectCells(const Asked& asked, const Vec3i& brick) {
  const std::uint32_t index = asked.grid.index(brick);
  if (!(asked.bounds[index].highest > asked.isovalue)) return {};
  VoxelBox cells = asked.grid.box(index);
  // They end at the first voxels of the next brick.
  cells.last = (cells.last + Vec3i::Ones()).cwiseMin(asked.grid.size - Vec3i::Ones());
  return isBehindOne(cells, asked.planes) ? VoxelBox{} : cells;
}

void widen(VoxelBox& box, const VoxelBox& other) {
  if (!other.empty()) box = box.empty() ? other : hull(box, other);
}

// The box of the voxels of some bricks that are object, and of the cells around these.
VoxelBox objectVoxels(const Asked& asked, const Volume& volume, const VoxelBox& bricks) {
  VoxelBox box;
  std::array<float, kBrickVoxels> densities{};
  for (int k = bricks.first.z(); k <= bricks.last.z(); ++k) {
    for (int j = bricks.first.y(); j <= bricks.last.y(); ++j) {
      for (int i = bricks.first.x(); i <= bricks.last.x(); ++i) {
        const Vec3i brick(i, j, k);
        if (objectCells(asked, brick).empty()) continue;
        if (volume.readBrick(brick, densities.data())) densities.fill(densities[0]);
        for (int n = 0; n < kBrickVoxels; ++n) {
          const Vec3i in_brick(n % kBrickSize, n / kBrickSize % kBrickSize, n / (kBrickSize * kBrickSize));
          const Vec3i voxel = kBrickSize * brick + in_brick;
          if (densities[static_cast<std::size_t>(n)] > asked.isovalue) widen(box, {voxel, voxel});
        }
      }
    }
  }
  return box.empty() ? box : asked.grid.widened(box, Vec3i::Ones());
}

// The object's box [voxel], given that of the bricks whose cells hold it; without clips. Only the outermost layer of
// bricks on each side is looked at. Where none of a layer's own voxels is object, its cells reach the object at the
// next layer's first voxels.
VoxelBox narrowed(const Asked& asked, const Volume& volume, const VoxelBox& bricks, VoxelBox object) {
  for (int axis = 0; axis < 3; ++axis) {
    VoxelBox low = bricks, high = bricks;
    low.last[axis] = bricks.first[axis];
    high.first[axis] = bricks.last[axis];
    const VoxelBox begin = objectVoxels(asked, volume, low), end = objectVoxels(asked, volume, high);
    object.first[axis] = begin.empty() ? kBrickSize * (bricks.first[axis] + 1) - 1 : begin.first[axis];
    if (!end.empty()) object.last[axis] = end.last[axis];
  }
  return object;
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
                        float isovalue, std::span<const ViewPlane> clips, const Volume* volume) {
  const Asked asked{bounds, grid, isovalue, onLattice(clips, lattice)};
  VoxelBox object, bricks;
  std::vector<std::vector<VoxelBox>> layers;  // of rows of bricks along i
  for (int k = 0; k < grid.counts().z(); ++k) {
    std::vector<VoxelBox>& rows = layers.emplace_back();
    for (int j = 0; j < grid.counts().y(); ++j) {
      VoxelBox row;
      for (int i = 0; i < grid.counts().x(); ++i) {
        const VoxelBox cells = objectCells(asked, {i, j, k});
        widen(row, cells);
        if (!cells.empty()) widen(bricks, {{i, j, k}, {i, j, k}});
      }
      if (!row.empty()) rows.push_back(row);
      widen(object, row);
    }
  }
  if (object.empty()) return wholeExtent(grid, lattice, clips);
  if (volume != nullptr && clips.empty()) object = narrowed(asked, *volume, bricks, object);
  SeenExtent extent;
  for (std::vector<VoxelBox>& rows : layers) {
    for (VoxelBox& row : rows) row = intersection(row, object);
    std::erase_if(rows, [](const VoxelBox& row) { return row.empty(); });
    addLayer(rows, lattice, extent.points_W);
  }
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
