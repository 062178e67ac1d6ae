// SPDX-License-Identifier: Apache-2.0
// engine/passes/camera.hpp: a pinhole camera in the world, and the picture that a renderer gives for it.
#pragma once

#include <cstdint>
#include <vector>

#include "base/vec.hpp"

namespace palpate {

struct Camera {
  Vec3 position_W = Vec3::Zero();       // [m]
  Vec3 forward_W = Vec3::UnitY();       // orthonormal, right-handed: right x up = -forward [-]
  Vec3 right_W = Vec3::UnitX();
  Vec3 up_W = Vec3::UnitZ();
  double vertical_view_rad = 0.5;       // full angle of view from bottom to top [rad]
  int width = 0;                        // [pixel]
  int height = 0;
};

struct RenderedImage {
  int width = 0;
  int height = 0;
  std::vector<std::uint32_t> rgba;  // 8 bits each, red lowest; alpha 0 where nothing is hit; row 0 on top
  std::vector<float> depth_m;       // along the pixel's ray; infinity where nothing is hit [m]
};

}  // namespace palpate
