// SPDX-License-Identifier: Apache-2.0
#include "engine/draw/picture_image.hpp"

#include <cstring>

namespace palpate {

RenderedImage asImage(int width, int height, std::span<const layout::PicturePixel> pixels) {
  RenderedImage image{width, height, {}, {}};
  image.rgba.resize(4 * pixels.size());
  image.distance_m.resize(pixels.size());
  for (std::size_t i = 0; i < pixels.size(); ++i) {
    const bool shows = pixels[i].rgba >> 24U != 0;
    const std::uint32_t rgba = shows ? layout::pictureOver(pixels[i].rgba, PICTURE_BACKGROUND) : PICTURE_BACKGROUND;
    std::memcpy(&image.rgba[4 * i], &rgba, 4);  // red lowest, so red first on a little-endian host
    image.distance_m[i] = pixels[i].distance_m;
  }
  return image;
}

}  // namespace palpate
