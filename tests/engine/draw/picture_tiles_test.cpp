// SPDX-License-Identifier: Apache-2.0
// Which pixels are drawn when: each once, and after a change all those whose rays pass it.
#include "engine/draw/picture_tiles.hpp"

#include <algorithm>
#include <map>
#include <random>
#include <utility>

#include <gtest/gtest.h>

namespace palpate {
namespace picture_tiles_test {

Camera cameraOf(int width, int height) {
  return lookAt(Vec3::Zero(), Vec3(0.6, -0.64, 0.48), 0.3, Vec3::UnitZ(), width, height, 0.5);
}

// How often each pixel of the picture comes in the batches that are left; squares count for `shown`.
struct Drawn {
  std::vector<int> computed, shown;
};
Drawn drawAll(PictureTiles& tiles, int width, int height, std::size_t most) {
  Drawn drawn{std::vector<int>(static_cast<std::size_t>(width * height)),
              std::vector<int>(static_cast<std::size_t>(width * height))};
  while (!tiles.done()) {
    const TileBatch batch = tiles.next(most);
    EXPECT_LE(batch.tiles.size(), most);
    EXPECT_FALSE(batch.tiles.empty());
    for (const std::uint32_t tile : batch.tiles) {
      for (std::uint32_t i = 0; i < 64; ++i) {
        const int x = static_cast<int>(((tile & 65535) * 8 + i % 8) * batch.grid.stride + batch.grid.x);
        const int y = static_cast<int>(((tile >> 16) * 8 + i / 8) * batch.grid.stride + batch.grid.y);
        if (x >= width || y >= height) continue;
        ++drawn.computed[static_cast<std::size_t>(y) * width + x];
        for (int b = y; b < std::min(height, y + static_cast<int>(batch.grid.square)); ++b) {
          for (int a = x; a < std::min(width, x + static_cast<int>(batch.grid.square)); ++a)
            ++drawn.shown[static_cast<std::size_t>(b) * width + a];
        }
      }
    }
  }
  return drawn;
}

TEST(PictureTiles, EveryPixelIsDrawnOnce) {
  for (const auto& [width, height] :
       {std::pair(1, 1), std::pair(3, 2), std::pair(8, 8), std::pair(61, 47), std::pair(130, 33)}) {
    for (const auto& [order, coarsest] :
         {std::pair(DrawOrder::kWhole, 4U), {DrawOrder::kCoarseFirst, 4U}, {DrawOrder::kCoarseFirst, 8U}}) {
      SCOPED_TRACE(testing::Message() << width << " x " << height);
      PictureTiles tiles;
      tiles.start(cameraOf(width, height), order, coarsest);
      const Drawn drawn = drawAll(tiles, width, height, 5);
      EXPECT_EQ(std::ranges::count(drawn.computed, 1), width * height);
      EXPECT_TRUE(tiles.next(5).tiles.empty());
    }
  }
}

// After the first grid the whole picture shows something.
TEST(PictureTiles, CoarsePixelsCoverThePicture) {
  for (const std::uint32_t coarsest : {4U, 8U}) {
    PictureTiles tiles;
    tiles.start(cameraOf(61, 47), DrawOrder::kCoarseFirst, coarsest);
    std::vector<int> shown(std::size_t{61} * 47);
    EXPECT_FALSE(tiles.coarse());
    while (!tiles.coarse()) {
      const TileBatch batch = tiles.next(3);
      EXPECT_EQ(batch.grid, (TileGrid{coarsest, 0, 0, coarsest}));
      const std::uint32_t side = 8 * coarsest;
      for (const std::uint32_t tile : batch.tiles) {
        for (std::uint32_t i = 0; i < side * side; ++i) {
          const std::uint32_t x = (tile & 65535) * side + i % side, y = (tile >> 16) * side + i / side;
          if (x < 61 && y < 47) ++shown[y * 61 + x];
        }
      }
    }
    EXPECT_EQ(std::ranges::count(shown, 1), 61 * 47);
  }
}

// Points in boxes at random, some around the camera: the pixel where the camera sees one is drawn anew.
TEST(PictureTiles, ChangesAreDrawnWhereverTheyAreSeen) {
  std::mt19937 random(9);
  std::uniform_real_distribution<double> unit(0, 1);
  Lattice lattice;
  lattice.origin_W = Vec3(-0.03, -0.02, -0.05);
  lattice.spacing_m = Vec3(0.7e-3, 0.9e-3, 1.3e-3);
  const Camera camera = cameraOf(97, 61);
  int seen = 0, whole = 0;
  for (int trial = 0; trial < 300; ++trial) {
    PictureTiles tiles;
    tiles.start(camera, DrawOrder::kWhole);
    static_cast<void>(drawAll(tiles, 97, 61, 1000));
    ASSERT_TRUE(tiles.done());
    const double reach = trial % 10 == 0 ? 400 : 80;
    const Vec3 low(reach * unit(random) - 10, reach * unit(random) - 10, -reach * unit(random) / 2 + 30);
    const Vec3 high = low + Vec3(20 * unit(random), 20 * unit(random), (trial % 10 == 0 ? 300 : 20) * unit(random));
    tiles.changed(lattice, low, high, 1);
    const Drawn drawn = drawAll(tiles, 97, 61, 7);
    whole += std::ranges::count(drawn.computed, 1) == std::ptrdiff_t{97} * 61;
    for (int i = 0; i < 200; ++i) {
      const Vec3 p_L = low + Vec3(unit(random), unit(random), unit(random)).cwiseProduct(high - low);
      const auto pixel = camera.project(lattice.toWorld(p_L));
      if (!pixel || pixel->x < 0 || pixel->y < 0 || pixel->x >= 97 || pixel->y >= 61) continue;
      ++seen;
      ASSERT_EQ(drawn.computed[static_cast<std::size_t>(pixel->y) * 97 + static_cast<std::size_t>(pixel->x)], 1)
          << trial;
    }
  }
  EXPECT_GT(seen, 5000);
  EXPECT_LT(whole, 100);  // and mostly not more than that
}

TEST(PictureTiles, AChangeBesideThePictureDrawsNothing) {
  PictureTiles tiles;
  const Camera camera = lookAt(Vec3::Zero(), Vec3::UnitX(), 1, Vec3::UnitZ(), 80, 80, 0.5);
  tiles.start(camera, DrawOrder::kWhole);
  static_cast<void>(drawAll(tiles, 80, 80, 1000));
  Lattice lattice;                                                // 1 mm
  tiles.changed(lattice, Vec3(0, 500, 0), Vec3(10, 510, 10), 1);  // half a metre to the side: 27 degrees, of 14 seen
  EXPECT_TRUE(tiles.done());
  tiles.changed(lattice, Vec3(-5, -5, -5), Vec3(5, 5, 5), 2);  // at the middle: 10 of 511 mm across
  EXPECT_FALSE(tiles.done());
  const Drawn drawn = drawAll(tiles, 80, 80, 1000);
  EXPECT_EQ(std::ranges::count(drawn.computed, 1),
            4 * 64);  // 1.6 pixels and one more beside: the four tiles that meet there
}

// What changed comes as soon as the first grid is out, before the finer ones; what the first grid has not drawn yet
// need not be drawn twice.
TEST(PictureTiles, ChangesComeAfterTheFirstGrid) {
  PictureTiles tiles;
  const Camera camera = lookAt(Vec3::Zero(), Vec3::UnitX(), 1, Vec3::UnitZ(), 80, 80, 0.5);
  const Vec3 low(-5, -5, -5), high(5, 5, 5);  // the middle: tiles 4 and 5, in coarse tile 1
  tiles.start(camera, DrawOrder::kCoarseFirst);
  static_cast<void>(tiles.next(2));  // of three by three tiles of 32 pixels
  tiles.changed(Lattice{}, low, high, 1);
  EXPECT_EQ(tiles.next(3).grid, (TileGrid{4, 0, 0, 4}));
  tiles.changed(Lattice{}, low, high, 1);  // now tile (1, 1) is out
  EXPECT_EQ(tiles.next(100).grid, (TileGrid{4, 0, 0, 4}));
  EXPECT_TRUE(tiles.coarse());
  const TileBatch batch = tiles.next(100);
  EXPECT_EQ(batch.grid, TileGrid{});
  EXPECT_EQ(batch.tiles, (std::vector<std::uint32_t>{4 | 4 << 16, 5 | 4 << 16, 4 | 5 << 16, 5 | 5 << 16}));
  EXPECT_EQ(tiles.next(100).grid, (TileGrid{4, 2, 0, 2}));
}

// Changes without end: the first grid is out in as many batches as without them.
TEST(PictureTiles, ChangesDoNotKeepThePictureFromAppearing) {
  for (const auto order : {DrawOrder::kCoarseFirst, DrawOrder::kWhole}) {
    PictureTiles tiles;
    tiles.start(cameraOf(130, 90), order);
    int batches = 0;
    for (; !tiles.coarse(); ++batches) {
      static_cast<void>(tiles.next(1));
      tiles.changed(Lattice{}, Vec3::Constant(-100), Vec3::Constant(100), 1);
    }
    EXPECT_EQ(batches, order == DrawOrder::kWhole ? 17 * 12 : 5 * 3);
    EXPECT_FALSE(tiles.done());
  }
}

// What has been stale for longest comes first, though changes go on above it, so no pixel waits for more than one round
// of all that are stale; and the oldest version that is not drawn yet is known.
TEST(PictureTiles, NoChangeWaitsForLaterOnes) {
  PictureTiles tiles;
  const Camera camera = lookAt(Vec3::Zero(), Vec3::UnitX(), 1, Vec3::UnitZ(), 80, 80, 0.5);
  tiles.start(camera, DrawOrder::kWhole);
  static_cast<void>(drawAll(tiles, 80, 80, 1000));
  EXPECT_FALSE(tiles.oldestStale().has_value());
  const Vec3 half = Vec3::Constant(5);
  const Vec3 low(0, 0, -100), high(0, 0, 100);  // 15 pixels below and above the middle
  const auto change = [&](const Vec3& at, std::uint64_t version) {
    tiles.changed(Lattice{}, at - half, at + half, version);
  };
  change(low, 1);
  EXPECT_EQ(tiles.oldestStale(), 1U);
  const std::uint32_t first = tiles.next(1).tiles.at(0);
  for (std::uint64_t version = 2; version < 40; ++version) {
    change(high, version);
    change(low, version);
    ASSERT_TRUE(tiles.fine());
    ASSERT_FALSE(tiles.done());
    const std::uint64_t oldest = tiles.oldestStale().value();
    ASSERT_LE(oldest, version);
    ASSERT_GE(oldest + 12, version);  // some four tiles a place, a tile each version
    static_cast<void>(tiles.next(1));
  }
  std::vector<std::uint32_t> rest;
  while (!tiles.done()) rest.push_back(tiles.next(1).tiles.at(0));
  EXPECT_LE(rest.size(), 12U);
  EXPECT_FALSE(tiles.oldestStale().has_value());
  EXPECT_GT(first >> 16U, 4U);  // below the middle
}

// A box behind the camera is not seen; one around it is seen everywhere.
TEST(PictureTiles, WhatIsBehindTheCameraIsNotSeen) {
  const Camera camera = lookAt(Vec3::Zero(), Vec3::UnitX(), 0.1, Vec3::UnitZ(), 80, 80, 0.5);  // at x = 0.1, to -x
  const auto pixels = [&](double low, double high) {
    const PixelBox box = pixelsOf(camera, Lattice{}, Vec3(low, -5, -5), Vec3(high, 5, 5));
    return std::max(0, box.last_x - box.x + 1) * std::max(0, box.last_y - box.y + 1);
  };
  EXPECT_EQ(pixels(101, 120), 0);
  EXPECT_EQ(pixels(90, 120), 80 * 80);
  EXPECT_GT(pixels(-10, 10), 0);
  EXPECT_LT(pixels(-10, 10), 80 * 80);
}

TEST(PictureTiles, TellTheShareThatIsOut) {
  for (const auto order : {DrawOrder::kCoarseFirst, DrawOrder::kWhole}) {
    PictureTiles tiles;
    tiles.start(cameraOf(61, 47), order);
    double last = tiles.share();
    EXPECT_EQ(last, 0);
    while (!tiles.done()) {
      static_cast<void>(tiles.next(3));
      EXPECT_GE(tiles.share(), last);
      EXPECT_LE(tiles.share(), 1);
      last = tiles.share();
    }
    EXPECT_EQ(last, 1);
  }
}

}  // namespace picture_tiles_test
}  // namespace palpate
