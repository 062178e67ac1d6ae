// SPDX-License-Identifier: Apache-2.0
#include "engine/draw/picture_tiles.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "shaders/draw.layout.h"

namespace palpate {
namespace {

std::uint32_t tilesAlong(int pixels, const TileGrid& grid, std::uint32_t offset) {
  const int left = std::max(pixels - static_cast<int>(offset), 0);
  const int length = DRAW_TILE * static_cast<int>(grid.stride);
  return static_cast<std::uint32_t>((left + length - 1) / length);
}

std::uint32_t tile(std::size_t x, std::size_t y) {
  return static_cast<std::uint32_t>(x | y << 16U);
}

}  // namespace

PixelBox pixelsOf(const Camera& camera, const Lattice& lattice, const Vec3& low, const Vec3& high) {
  const PixelBox all{0, 0, camera.width - 1, camera.height - 1};
  int behind = 0;  // corners behind the camera
  constexpr double kFar = std::numeric_limits<double>::infinity();
  double first_x = kFar, first_y = kFar, last_x = -kFar, last_y = -kFar;
  for (int corner = 0; corner < 8; ++corner) {
    const Vec3 p_L((corner & 1) == 0 ? low.x() : high.x(), (corner & 2) == 0 ? low.y() : high.y(),
                   (corner & 4) == 0 ? low.z() : high.z());
    const auto seen = camera.project(lattice.toWorld(p_L));
    if (!seen) {
      ++behind;
      continue;
    }
    first_x = std::min(first_x, seen->x);
    first_y = std::min(first_y, seen->y);
    last_x = std::max(last_x, seen->x);
    last_y = std::max(last_y, seen->y);
  }
  if (behind == 8) return {};
  if (behind > 0) return all;
  // A pixel more on each side: rays are computed in float.
  const auto cut = [](double pixel, int most) {
    return static_cast<int>(std::clamp(std::floor(pixel), -1.0, most + 0.0));
  };
  return {std::max(cut(first_x - 1, camera.width), 0), std::max(cut(first_y - 1, camera.height), 0),
          std::min(cut(last_x + 1, camera.width), camera.width - 1),
          std::min(cut(last_y + 1, camera.height), camera.height - 1)};
}

void PictureTiles::start(const Camera& camera, DrawOrder order, std::uint32_t coarsest) {
  camera_ = camera;
  next_tile_ = 0;
  stale_.clear();
  coarse_ = false;
  const TileGrid whole;
  is_stale_.assign(std::size_t{tilesAlong(camera.width, whole, 0)} * tilesAlong(camera.height, whole, 0), false);
  if (order == DrawOrder::kWhole) {
    grids_ = {whole};
    return;
  }
  grids_ = {{coarsest, 0, 0, coarsest}};
  for (std::uint32_t stride = coarsest; stride > 1; stride /= 2) {
    const std::uint32_t half = stride / 2;
    grids_.insert(grids_.end(), {{stride, half, 0, half}, {stride, 0, half, half}, {stride, half, half, half}});
  }
  std::erase_if(grids_, [&](const TileGrid& grid) {  // that begin beside a small picture
    return static_cast<int>(grid.x) >= camera.width || static_cast<int>(grid.y) >= camera.height;
  });
}

// What was not handed out yet will be drawn as it is then.
bool PictureTiles::isDrawn(int tile_x, int tile_y) const noexcept {
  if (coarse_ || grids_.empty()) return true;
  const auto stride = static_cast<int>(grids_.front().stride);
  const std::size_t row = tilesAlong(camera_.width, grids_.front(), 0);
  return static_cast<std::size_t>(tile_y / stride) * row + static_cast<std::size_t>(tile_x / stride) < next_tile_;
}

void PictureTiles::changed(const Lattice& lattice, const Vec3& low, const Vec3& high, std::uint64_t version) {
  if (stale_.size() == is_stale_.size()) return;
  const PixelBox box = pixelsOf(camera_, lattice, low, high);
  const std::size_t row = tilesAlong(camera_.width, {}, 0);
  for (int y = box.y / DRAW_TILE; y <= box.last_y / DRAW_TILE && box.last_y >= 0; ++y) {
    for (int x = box.x / DRAW_TILE; x <= box.last_x / DRAW_TILE && box.last_x >= 0; ++x) {
      const std::size_t at = static_cast<std::size_t>(y) * row + static_cast<std::size_t>(x);
      if (at >= is_stale_.size() || is_stale_[at] || !isDrawn(x, y)) continue;
      is_stale_[at] = true;
      stale_.push_back({at, version});
    }
  }
}

double PictureTiles::share() const noexcept {
  const auto along = [](int length, std::uint32_t from, std::uint32_t stride) {
    return std::max(0.0, std::ceil((length - static_cast<double>(from)) / stride));
  };
  double left = 0, out = static_cast<double>(next_tile_) * DRAW_TILE * DRAW_TILE;  // tiles at the rim hold fewer pixels
  for (const TileGrid& grid : grids_) {
    left += std::max(0.0, along(camera_.width, grid.x, grid.stride) * along(camera_.height, grid.y, grid.stride) - out);
    out = 0;
  }
  return 1 - left / std::max(1.0, static_cast<double>(camera_.width) * camera_.height);
}

TileBatch PictureTiles::nextStale(std::size_t most) {
  TileBatch batch;
  const std::size_t row = tilesAlong(camera_.width, {}, 0);
  for (; !stale_.empty() && batch.tiles.size() < most; stale_.pop_front()) {
    const std::size_t at = stale_.front().tile;
    is_stale_[at] = false;
    batch.tiles.push_back(tile(at % row, at / row));
  }
  return batch;
}

TileBatch PictureTiles::next(std::size_t most) {
  if (!stale_.empty() && (coarse_ || grids_.empty())) return nextStale(most);
  TileBatch batch;
  while (batch.tiles.empty() && !grids_.empty()) {
    batch.grid = grids_.front();
    const std::size_t row = tilesAlong(camera_.width, batch.grid, batch.grid.x);
    const std::size_t count = row * tilesAlong(camera_.height, batch.grid, batch.grid.y);
    for (; next_tile_ < count && batch.tiles.size() < most; ++next_tile_)
      batch.tiles.push_back(tile(next_tile_ % row, next_tile_ / row));
    if (next_tile_ < count) break;
    grids_.pop_front();
    next_tile_ = 0;
    coarse_ = true;
  }
  return batch;
}

}  // namespace palpate
