// SPDX-License-Identifier: Apache-2.0
#include "apps/touch/scripted_path.hpp"

#include <algorithm>
#include <limits>

#include <fmt/format.h>

#include "apps/path/path_csv.hpp"
#include "apps/path/touch_path.hpp"
#include "base/units.hpp"

namespace palpate {
namespace {

SampledPath sampled(const std::vector<TimedPoint>& points) {
  std::vector<double> times_s;
  std::vector<Vec3> points_W;
  for (const TimedPoint& point : points) {
    times_s.push_back(point.time_s);
    points_W.push_back(point.p_W);
  }
  return {std::move(times_s), std::move(points_W), SampledPath::Interpolation::kCubic};
}

PathRequest requestOf(const Scene& scene) {
  return {.duration_s = scene.duration_s,
          .approach_m = scene.approach_m,
          .press_depth_m = scene.press_depth_m,
          .slide_length_m = scene.slide_length_m,
          .over_edges = scene.straight_over_edges ? OverEdges::kStraight : OverEdges::kFollow,
          .toward_W = scene.path_toward,
          .start_W = scene.path_start_W,
          .slide_W = scene.path_slide};
}

// How far a point is from the box of voxel centres [m].
double distanceToVolume(const SurfaceField& surface, const Vec3& p_W) {
  const Vec3 p_L = surface.lattice().toIndex(p_W);
  const Vec3 last_L = surface.size().cast<double>().array() - 1;
  const Vec3 nearest_L = p_L.cwiseMax(0).cwiseMin(last_L);
  return (p_L - nearest_L).cwiseProduct(surface.lattice().spacing_m).norm();
}

// A path outside the volume feels nothing, and one that goes far away is followed there. The usual cause is a file in
// millimetres.
std::vector<std::string> notesOnReach(const SurfaceField& surface, const std::vector<TimedPoint>& points) {
  constexpr double kFar = 10;  // diagonals of the volume
  double nearest_m = std::numeric_limits<double>::infinity(), farthest_m = 0;
  for (const TimedPoint& point : points) {
    const double away_m = distanceToVolume(surface, point.p_W);
    nearest_m = std::min(nearest_m, away_m);
    farthest_m = std::max(farthest_m, away_m);
  }
  if (nearest_m > 0)
    return {
        fmt::format("the path never enters the volume: its nearest point is {:.3g} mm away; are its coordinates in "
                    "metres, and in the volume's world?",
                    nearest_m * kMillimetresPerMetre)};
  const Vec3 size_m = (surface.size().cast<double>().array() - 1).matrix().cwiseProduct(surface.lattice().spacing_m);
  if (farthest_m <= kFar * size_m.norm()) return {};
  return {
      fmt::format("the path goes {:.3g} m away from the volume, which is {:.3g} m across; are its coordinates in "
                  "metres?",
                  farthest_m, size_m.norm())};
}

}  // namespace

ScriptedPath scriptedPath(const Scene& scene, const SurfaceField& surface) {
  if (!scene.path_file.empty()) {
    const std::vector<TimedPoint> points = readPathCsv(scene.path_file);
    return {.path = sampled(points), .phases = {}, .notes = notesOnReach(surface, points)};
  }
  TouchPath built = buildTouchPath(surface, requestOf(scene));
  return {.path = sampled(built.points),
          .phases = std::move(built.phases),
          .notes = std::move(built.notes),
          .depth_m = built.depth_m,
          .slide_m = built.slid_m,
          .approach_m = built.approach_m,
          .start_W = built.start.p_W,
          .slide_W = built.slide_W.isZero(0) ? std::nullopt : std::optional(built.slide_W)};
}

}  // namespace palpate
