// SPDX-License-Identifier: Apache-2.0
// apps/view/picture_png.hpp: a drawn picture as a PNG file, with nothing added.
#pragma once

#include <functional>
#include <string>

#include "base/camera.hpp"

namespace palpate {

// Bytes of the file: 8 bits of red, green and blue a pixel; alpha is ignored. `image` is complete(). `between` is
// called with every piece of the file, and may throw to cancel. Any thread. Cost: some 30 ns a pixel, and 8 bytes of
// memory. Throws Error(kOutOfMemory).
[[nodiscard]] std::string pngOf(const RenderedImage& image, const std::function<void()>& between = {});

}  // namespace palpate
