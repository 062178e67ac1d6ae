// SPDX-License-Identifier: Apache-2.0
#include "apps/sculpt/orbit_view.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

namespace palpate {

OrbitView::OrbitView(SeenExtent extent, int width, int height)
    : width_(std::max(width, 1)), height_(std::max(height, 1)), target_W_(extent.middle_W) {
  setExtent(std::move(extent));
  fit();
}

void OrbitView::setExtent(SeenExtent extent) {
  extent_ = std::move(extent);
  radius_m_ = 0;
  for (const Vec3& point_W : extent_.points_W) radius_m_ = std::max(radius_m_, (point_W - extent_.middle_W).norm());
}

RenderRequest OrbitView::request() const {
  RenderRequest request;
  request.width = width_;
  request.height = height_;
  request.fov_rad = kFov_rad;
  request.view = angles_;
  return request;
}

Camera OrbitView::camera() const {
  return frameCamera(request(), target_W_, distance_m_, 0);
}

void OrbitView::resize(int width, int height) {
  width_ = std::max(width, 1);
  height_ = std::max(height, 1);
}

void OrbitView::fit() {
  target_W_ = extent_.middle_W;
  distance_m_ = fittingDistance(request(), extent_);
}

void OrbitView::orbit(double right_px, double down_px) {
  const double turn = std::numbers::pi / height_;
  angles_.azimuth_rad = std::remainder(angles_.azimuth_rad - turn * right_px, 2 * std::numbers::pi);
  angles_.elevation_rad =
      std::clamp(angles_.elevation_rad + turn * down_px, -std::numbers::pi / 2, std::numbers::pi / 2);
}

void OrbitView::pan(double right_px, double down_px, double distance_m) {
  const Camera now = camera();
  const double pixel_m = now.pixelSize(distance_m > 0 ? distance_m : distance_m_);
  target_W_ += pixel_m * (down_px * now.up_W - right_px * now.right_W);
}

// The camera moves on the line to the point, and the target with it.
void OrbitView::zoom(double steps, const Vec3& towards_W) {
  const double wanted_m = distance_m_ * std::pow(0.9, std::clamp(steps, -100.0, 100.0));
  const double next_m = std::clamp(wanted_m, kNearest * radius_m_, kFarthest * radius_m_);
  const double kept = next_m / distance_m_;
  target_W_ = towards_W + kept * (target_W_ - towards_W);
  distance_m_ = next_m;
}

}  // namespace palpate
