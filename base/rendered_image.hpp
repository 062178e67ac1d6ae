// SPDX-License-Identifier: Apache-2.0
// base/rendered_image.hpp: what a renderer gives for a camera: the colour and the distance of each pixel.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

namespace palpate {

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
