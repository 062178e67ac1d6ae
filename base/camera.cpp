// SPDX-License-Identifier: Apache-2.0
#include "base/camera.hpp"

#include <cmath>

namespace palpate {

std::optional<Camera::Projection> Camera::project(const Vec3& p_W) const noexcept {
  const Vec3 way_W = p_W - position_W;
  const double depth_m = way_W.dot(forward_W);
  if (!(depth_m > 0)) return std::nullopt;
  const double pixel_m = pixelSize(depth_m);
  return Projection{0.5 * width + way_W.dot(right_W) / pixel_m, 0.5 * height - way_W.dot(up_W) / pixel_m, way_W.norm()};
}

Vec3 Camera::rayThrough(double x, double y) const noexcept {
  const double pixel = pixelSize(1);
  return (forward_W + (x - 0.5 * width) * pixel * right_W + (0.5 * height - y) * pixel * up_W).normalized();
}

double Camera::pixelSize(double depth_m) const noexcept {
  return 2 * depth_m * std::tan(vertical_fov_rad / 2) / height;
}

Camera lookAt(const Vec3& target_W, const Vec3& from_W, double distance_m, const Vec3& up_W, int width, int height,
              double vertical_fov_rad) {
  Camera camera;
  camera.position_W = target_W + distance_m * from_W;
  camera.forward_W = -from_W;
  camera.right_W = camera.forward_W.cross(up_W).normalized();
  camera.up_W = camera.right_W.cross(camera.forward_W);
  camera.vertical_fov_rad = vertical_fov_rad;
  camera.width = width;
  camera.height = height;
  return camera;
}

}  // namespace palpate
