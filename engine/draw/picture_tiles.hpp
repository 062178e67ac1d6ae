// SPDX-License-Identifier: Apache-2.0
// engine/draw/picture_tiles.hpp: which pixels of a picture are to be drawn, in tiles of 8x8, and in which order. Any
// thread. Cost: a few operations a tile.
//
// A whole picture comes at once, or first every eighth or fourth pixel, then every second, then all. Once the first
// grid of pixels is out, those that a change has made stale come before everything else, the longest stale first, so
// that none waits for long however many changes follow.
#pragma once

#include <cstdint>
#include <deque>
#include <optional>
#include <vector>

#include "base/camera.hpp"
#include "base/lattice.hpp"
#include "engine/draw/draw_style.hpp"

namespace palpate {

// Pixels of tiles: pixel (x + stride * i, y + stride * j), each shown as a square of `square` pixels until finer ones
// come.
struct TileGrid {
  std::uint32_t stride = 1, x = 0, y = 0, square = 1;
  friend bool operator==(const TileGrid&, const TileGrid&) = default;
};

struct TileBatch {
  TileGrid grid;
  std::vector<std::uint32_t> tiles;  // x | y << 16, each 8 * stride pixels long
};

class PictureTiles {
 public:
  // Everything is to be drawn, from this camera. `coarsest`: of kCoarseFirst: every so many-th pixel comes first, 4
  // or 8.
  void start(const Camera& camera, DrawOrder order, std::uint32_t coarsest = 4);
  void again() { start(camera_, DrawOrder::kWhole); }
  // What is seen in this box of the lattice has changed [voxel, the ends included]. `version`: of the volume by then;
  // it never falls.
  void changed(const Lattice& lattice, const Vec3& low, const Vec3& high, std::uint64_t version);

  [[nodiscard]] bool done() const noexcept { return stale_.empty() && grids_.empty(); }
  // Every pixel was handed out, those aside that changed since.
  [[nodiscard]] bool fine() const noexcept { return grids_.empty(); }
  // The oldest version of which pixels are still to be drawn; empty: none.
  [[nodiscard]] std::optional<std::uint64_t> oldestStale() const noexcept {
    return stale_.empty() ? std::nullopt : std::optional(stale_.front().version);
  }
  // The first grid was handed out: the whole picture shows something.
  [[nodiscard]] bool coarse() const noexcept { return coarse_; }
  // Share of the pixels that were handed out, from 0 to 1; what changed since is not counted.
  [[nodiscard]] double share() const noexcept;
  // The next tiles, at most `most`, of one grid. Empty if done().
  [[nodiscard]] TileBatch next(std::size_t most);

 private:
  [[nodiscard]] TileBatch nextStale(std::size_t most);
  [[nodiscard]] bool isDrawn(int tile_x, int tile_y) const noexcept;

  Camera camera_;
  std::deque<TileGrid> grids_;  // yet to be drawn, the first one in part
  std::size_t next_tile_ = 0;   // of the first grid
  struct Stale {
    std::size_t tile;  // of stride 1
    std::uint64_t version;
  };
  std::deque<Stale> stale_;     // the oldest first
  std::vector<bool> is_stale_;  // by tile
  bool coarse_ = false;
};

// The pixels where a box of the lattice may be seen: first and last, cut to the picture; empty (last < first) where it
// is beside it.
struct PixelBox {
  int x = 0, y = 0, last_x = -1, last_y = -1;
};
[[nodiscard]] PixelBox pixelsOf(const Camera& camera, const Lattice& lattice, const Vec3& low, const Vec3& high);

}  // namespace palpate
