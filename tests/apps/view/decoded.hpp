// SPDX-License-Identifier: Apache-2.0
// Decodes a PNG file into pixels, and counts colours in it.
#pragma once

#include <cstdint>
#include <cstdlib>
#include <cstring>
#include <string>
#include <string_view>
#include <vector>

#include <cairo/cairo.h>

#include "apps/view/canvas.hpp"

namespace palpate {

struct Decoded {
  int width = 0, height = 0;
  std::vector<std::uint32_t> rgb;
  [[nodiscard]] std::uint32_t at(int x, int y) const {
    return rgb[static_cast<std::size_t>(y) * width + x] & 0xFFFFFFU;
  }
};

inline Decoded decode(const std::string& png) {
  std::string_view rest = png;
  const auto read = [](void* from, unsigned char* to, unsigned int count) {
    auto& text = *static_cast<std::string_view*>(from);
    if (text.size() < count) return CAIRO_STATUS_READ_ERROR;
    std::memcpy(to, text.data(), count);
    text.remove_prefix(count);
    return CAIRO_STATUS_SUCCESS;
  };
  cairo_surface_t* surface = cairo_image_surface_create_from_png_stream(read, &rest);
  Decoded out{cairo_image_surface_get_width(surface), cairo_image_surface_get_height(surface), {}};
  for (int y = 0; y < out.height; ++y) {
    const auto* row = reinterpret_cast<const std::uint32_t*>(
        cairo_image_surface_get_data(surface) + std::ptrdiff_t{y} * cairo_image_surface_get_stride(surface));
    out.rgb.insert(out.rgb.end(), row, row + out.width);
  }
  cairo_surface_destroy(surface);
  return out;
}

// Whether a pixel has this colour, drawn on white, within rounding.
inline bool hasColor(const Decoded& image, int x, int y, const Color& color) {
  const std::uint32_t pixel = image.at(x, y);
  const auto channel = [&](double share) { return 255 * (1 - color.alpha + color.alpha * share); };
  const auto near = [](std::uint32_t is, double wanted) {
    return std::abs(static_cast<double>(is & 255U) - wanted) < 4;
  };
  return near(pixel >> 16U, channel(color.red)) && near(pixel >> 8U, channel(color.green)) &&
         near(pixel, channel(color.blue));
}

// The number of pixels of this colour in the box [left, right) x [top, bottom).
inline int countColor(const Decoded& image, int left, int top, int right, int bottom, const Color& color) {
  int count = 0;
  for (int y = top; y < bottom; ++y) {
    for (int x = left; x < right; ++x) count += hasColor(image, x, y, color) ? 1 : 0;
  }
  return count;
}

}  // namespace palpate
