// SPDX-License-Identifier: Apache-2.0
#include "apps/sculpt/pointer_tool.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace palpate {
namespace {

// The pixel's distance along its ray; infinite where nothing is hit, empty outside the picture.
std::optional<double> distanceAt(const ViewFrame& frame, double x, double y) {
  const auto width = static_cast<double>(frame.camera.width), height = static_cast<double>(frame.camera.height);
  if (!(x >= 0 && y >= 0 && x < width && y < height)) return std::nullopt;
  const std::size_t at =
      static_cast<std::size_t>(y) * static_cast<std::size_t>(frame.camera.width) + static_cast<std::size_t>(x);
  if (at >= frame.pixels.size()) return std::nullopt;
  return frame.pixels[at].distance_m;
}

// The nearest and the farthest distance in a pixel and its neighbours, as far as they are in the picture.
struct Distances {
  double nearest_m = std::numeric_limits<double>::infinity(), farthest_m = 0;
};
Distances distancesAround(const ViewFrame& frame, double x, double y) {
  Distances around;
  for (int down = -1; down <= 1; ++down) {
    for (int right = -1; right <= 1; ++right) {
      const std::optional<double> distance_m = distanceAt(frame, x + right, y + down);
      if (!distance_m) continue;
      around.nearest_m = std::min(around.nearest_m, *distance_m);
      around.farthest_m = std::max(around.farthest_m, *distance_m);
    }
  }
  return around;
}

}  // namespace

std::optional<Vec3> PointerTool::surface_W(const ViewFrame& frame, double x, double y) {
  const std::optional<double> distance_m = distanceAt(frame, x, y);
  if (!distance_m || !std::isfinite(*distance_m)) return std::nullopt;
  return frame.camera.position_W + *distance_m * frame.camera.rayThrough(x, y);
}

std::optional<Vec3> PointerTool::hip_W(const ViewFrame& frame, double x, double y, bool presses,
                                       const PointerReach& reach) {
  const std::optional<double> distance_m = distanceAt(frame, x, y);
  if (!distance_m) return std::nullopt;
  const Camera& camera = frame.camera;
  const Vec3 ray_W = camera.rayThrough(x, y);
  const double slant = ray_W.dot(camera.forward_W);
  const bool hits = std::isfinite(*distance_m);
  if (hits) distance_m_ = *distance_m * slant;
  const double way_m = hits && presses ? reach.depth_m : -std::min(reach.lift_m, distance_m_ / slant / 2);
  last_camera_ = camera;
  last_W_ = camera.position_W + (distance_m_ / slant + way_m) * ray_W;
  return last_W_;
}

// Pixels are as wide as the surface slants in them: a place counts as behind what is farthest in the pixel and its
// neighbours.
std::optional<double> PointerTool::behind_m(const ViewFrame& frame, const Vec3& p_W) {
  const auto seen = frame.camera.project(p_W);
  if (!seen || !distanceAt(frame, seen->x, seen->y)) return std::nullopt;
  return (p_W - frame.camera.position_W).norm() - distancesAround(frame, seen->x, seen->y).farthest_m;
}

namespace {

// Whether the straight way is seen, and nowhere deeper behind the surface than `most_m`. It looks at every pixel on it.
bool isClear(const ViewFrame& frame, const Vec3& from_W, const Vec3& to_W, double most_m) {
  const auto from = frame.camera.project(from_W), to = frame.camera.project(to_W);
  if (!from || !to) return false;
  const double pixels = std::max(std::abs(to->x - from->x), std::abs(to->y - from->y));
  if (!(pixels < frame.camera.width + frame.camera.height)) return false;  // it begins or ends far beside the picture
  const int steps = 1 + static_cast<int>(pixels);
  for (int i = 0; i <= steps; ++i) {
    const double share = static_cast<double>(i) / steps;
    const auto behind_m = PointerTool::behind_m(frame, from_W + share * (to_W - from_W));
    if (!behind_m || *behind_m > most_m) return false;
  }
  return true;
}

}  // namespace

std::optional<PointerTarget> PointerTool::follow(const ViewFrame& frame, double x, double y, bool presses,
                                                 const PointerReach& reach, const Vec3& tool_W, double grows_m) {
  const std::optional<Vec3> to_W = hip_W(frame, x, y, presses, reach);
  if (!to_W) return std::nullopt;
  const double deepest_m = kDeepest * reach.depth_m + grows_m;
  const double now_m = behind_m(frame, tool_W).value_or(deepest_m);
  const double most_m = presses ? deepest_m : std::clamp(now_m, 0.0, deepest_m);
  if (isClear(frame, tool_W, *to_W, most_m)) return PointerTarget(*to_W);
  const double nearest_m = distancesAround(frame, x, y).nearest_m;
  if (!std::isfinite(nearest_m)) return PointerTarget(*to_W, *to_W);  // where nothing is
  const double lift_m = std::min(reach.lift_m, nearest_m / 2);
  return PointerTarget(*to_W, frame.camera.position_W + (nearest_m - lift_m) * frame.camera.rayThrough(x, y));
}

std::optional<PointerTarget> PointerTool::rest(const ViewFrame& frame, const Vec3& tool_W) {
  if (!last_W_) return std::nullopt;
  const Vec3 resting_W = (last_camera_.position_W + *last_W_) / 2;
  last_W_.reset();
  const double now_m = behind_m(frame, tool_W).value_or(0);
  const bool is_clear = frame.camera == last_camera_ && isClear(frame, tool_W, resting_W, std::max(0.0, now_m));
  return is_clear ? PointerTarget(resting_W) : PointerTarget(resting_W, resting_W);
}

}  // namespace palpate
