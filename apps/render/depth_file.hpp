// SPDX-License-Identifier: Apache-2.0
// apps/render/depth_file.hpp: a depth image as a PFM file (portable float map), which OpenCV, ImageMagick and others
// read.
//
// A header of three lines, "Pf", "WIDTH HEIGHT" and "-1.0" (one channel, little-endian), and then 32-bit floats, rows
// from the BOTTOM of the picture to its top, as the format has it. A value is the distance from the camera along the
// ray through the pixel's centre [m]; infinity where nothing is hit. Any thread.
#pragma once

#include <string>

#include "base/camera.hpp"

namespace palpate {

// The bytes of the file. `image` is complete(). Cost: a copy of the distances.
[[nodiscard]] std::string pfmOf(const RenderedImage& image);

}  // namespace palpate
