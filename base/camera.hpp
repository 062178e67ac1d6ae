// SPDX-License-Identifier: Apache-2.0
// base/camera.hpp: where a picture is taken from, where a point of the world appears in it, and the picture itself.
//
// World frame [m]. Pixels count from the top left corner; the centre of the first pixel is (0.5, 0.5). Any thread.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

#include "base/vec.hpp"

namespace palpate {

struct Camera {
  Vec3 position_W = Vec3::Zero();   // [m]
  Vec3 forward_W = -Vec3::UnitZ();  // unit, into the picture
  Vec3 right_W = Vec3::UnitX();     // unit
  Vec3 up_W = Vec3::UnitY();        // unit; forward x up = right
  double vertical_fov_rad = 0.5;    // angle between the upper and lower edge [rad]
  int width = 0, height = 0;        // [pixel]

  bool operator==(const Camera&) const = default;

  struct Projection {
    double x = 0, y = 0;    // [pixel]
    double distance_m = 0;  // from the camera along the ray, as in RenderedImage [m]
  };
  // Empty for a point that is not in front of the camera. Points beside the picture have pixels outside it.
  [[nodiscard]] std::optional<Projection> project(const Vec3& p_W) const noexcept;

  // Unit direction of the ray through a place in the picture.
  [[nodiscard]] Vec3 rayThrough(double x, double y) const noexcept;

  // Length in the world of one pixel at a distance along `forward` [m].
  [[nodiscard]] double pixelSize(double depth_m) const noexcept;
};

// A camera that looks at `target_W` from a distance of `distance_m`. `from_W` (unit) points from the target to the
// camera. `up_W` points upwards in the picture and may not be parallel to `from_W`.
[[nodiscard]] Camera lookAt(const Vec3& target_W, const Vec3& from_W, double distance_m, const Vec3& up_W, int width,
                            int height, double vertical_fov_rad);

// What a renderer gives for a camera: the colour and the distance of each pixel.
struct RenderedImage {
  int width = 0, height = 0;       // [pixel]
  std::vector<std::uint8_t> rgba;  // 4 bytes a pixel, rows from the top; sRGB; alpha is ignored
  std::vector<float> distance_m;   // along the ray through the pixel's centre [m]; infinity where nothing is hit
  [[nodiscard]] bool complete() const noexcept {
    const auto pixels = static_cast<std::size_t>(width) * static_cast<std::size_t>(height);
    return width > 0 && height > 0 && rgba.size() == 4 * pixels && distance_m.size() == pixels;
  }
};

}  // namespace palpate
