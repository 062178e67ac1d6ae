// SPDX-License-Identifier: Apache-2.0
#include "apps/view/picture_png.hpp"

#include "apps/view/canvas.hpp"

namespace palpate {

std::string pngOf(const RenderedImage& image, const std::function<void()>& between) {
  const std::unique_ptr<Canvas> canvas = makeCanvas(image.width, image.height);
  canvas->image(image, 0, 0);
  return canvas->png(between);
}

}  // namespace palpate
