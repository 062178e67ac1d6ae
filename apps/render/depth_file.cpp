// SPDX-License-Identifier: Apache-2.0
#include "apps/render/depth_file.hpp"

#include <bit>
#include <cstring>

#include <fmt/format.h>

namespace palpate {

std::string pfmOf(const RenderedImage& image) {
  static_assert(std::endian::native == std::endian::little, "values are copied as they are");
  std::string bytes = fmt::format("Pf\n{} {}\n-1.0\n", image.width, image.height);
  const std::size_t header = bytes.size();
  const auto height = static_cast<std::size_t>(image.height);
  const std::size_t row = static_cast<std::size_t>(image.width) * sizeof(float);
  bytes.resize(header + height * row);
  const auto* top = reinterpret_cast<const char*>(image.distance_m.data());
  for (std::size_t y = 0; y < height; ++y) std::memcpy(&bytes[header + y * row], top + (height - 1 - y) * row, row);
  return bytes;
}

}  // namespace palpate
