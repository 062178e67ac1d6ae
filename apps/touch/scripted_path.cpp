// SPDX-License-Identifier: Apache-2.0
#include "apps/touch/scripted_path.hpp"

#include "apps/path/path_csv.hpp"
#include "apps/path/touch_path.hpp"

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

}  // namespace

ScriptedPath scriptedPath(const Scene& scene, const SurfaceField& surface) {
  if (!scene.path_file.empty()) return {sampled(readPathCsv(scene.path_file)), {}, {}};
  TouchPath built = buildTouchPath(surface, requestOf(scene));
  return {sampled(built.points), std::move(built.phases), std::move(built.notes)};
}

}  // namespace palpate
