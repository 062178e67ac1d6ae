// SPDX-License-Identifier: Apache-2.0
#include "apps/sculpt/pointer_tool.hpp"

#include <cmath>

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
  const double way_m = hits && presses ? reach.depth_m : -reach.lift_m;
  last_W_ = camera.position_W + (distance_m_ / slant + way_m) * ray_W;
  return last_W_;
}

std::optional<Vec3> PointerTool::resting_W(const ViewFrame& frame) {
  if (!last_W_) return std::nullopt;
  const Vec3 resting_W = (frame.camera.position_W + *last_W_) / 2;
  last_W_.reset();
  return resting_W;
}

}  // namespace palpate
