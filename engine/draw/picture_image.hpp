// SPDX-License-Identifier: Apache-2.0
// engine/draw/picture_image.hpp: the pixels of a picture as an image over the background. Any thread; allocates.
#pragma once

#include <span>

#include "base/camera.hpp"
#include "shaders/draw.layout.h"

namespace palpate {

// `pixels`: rows from the top, width * height of them.
[[nodiscard]] RenderedImage asImage(int width, int height, std::span<const layout::PicturePixel> pixels);

}  // namespace palpate
