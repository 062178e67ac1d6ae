// SPDX-License-Identifier: Apache-2.0
// engine/draw/drawing.hpp: a picture of the isosurface that is kept up to date in small pieces of work, so that edits
// and windows for the servo come in between.
//
// The picture stays on the GPU: colour and distance of each pixel. After an edit only those pixels are drawn anew whose
// rays pass what changed. Every pixel then equals that of a new picture of the volume as it is.
// Thread: the Gpu's. Cost: shaders/draw.comp, docs/results/render.md.
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "base/camera.hpp"
#include "base/stopwatch.hpp"
#include "engine/draw/cell_tree.hpp"
#include "engine/draw/draw_style.hpp"
#include "engine/draw/picture_tiles.hpp"
#include "engine/gpu/commands.hpp"
#include "engine/gpu/transfer.hpp"
#include "engine/passes/brick_bounds_pass.hpp"
#include "engine/passes/brick_pool.hpp"
#include "engine/passes/host_list.hpp"
#include "engine/passes/pool_kernel.hpp"
#include "shaders/draw.layout.h"

namespace palpate {

class Drawing {
 public:
  // Of the field in `pool`, whose `bounds` are up to date whenever a piece of work begins. All outlive the drawing.
  Drawing(gpu::Gpu& gpu, gpu::Transfer& transfer, const BrickPool& pool, const BrickBoundsPass& bounds);
  ~Drawing();
  Drawing(const Drawing&) = delete;
  Drawing& operator=(const Drawing&) = delete;

  // What is drawn from now on, all of it anew. Waits for the piece under way. Throws Error(kBadInput) as checkStyle()
  // and drawPush() do, Error(kOutOfMemory), and then the former picture goes on. Cost of an isovalue that was not drawn
  // before: a cell tree, for which this waits; of a style that was not: perhaps the driver's compiler.
  void show(const Camera& camera, double isovalue, const DrawStyle& style = {}, DrawOrder order = DrawOrder::kWhole);
  // These bricks of the field hold something else since the last piece of work. `version`: of the volume by now.
  void changed(std::span<const ChangedBrick> bricks, std::uint64_t version);

  // Whether no piece of work is under way. Does not wait. Throws Error(kDevice).
  bool poll();
  // Submits the next piece of work, if none is under way; drawing it takes the device about `most_s`, following changes
  // comes on top. Returns whether the picture is whole. Does not wait. Throws Error(kDevice), Error(kOutOfMemory).
  bool advance(double most_s);
  void wait();  // for the piece under way, so that buffers may be replaced
  // Until the picture is whole. `between`: called between pieces; may throw to cancel.
  void finish(const std::function<void()>& between = {});

  [[nodiscard]] double share() const noexcept { return tiles_.share(); }     // of the picture that is drawn, 0 to 1
  [[nodiscard]] bool shows() const noexcept { return pixels_.has_value(); }  // something, since show()
  [[nodiscard]] bool whole() const noexcept { return !in_flight_ && tiles_.done() && changed_.empty(); }
  [[nodiscard]] PictureState state() const noexcept {
    return {pieces_, showable_, !in_flight_ && tiles_.fine(), whole(), shown_version_};
  }
  // A copy of what the GPU has drawn so far; waits for the piece under way.
  void copyTo(std::vector<layout::PicturePixel>& pixels);
  [[nodiscard]] RenderedImage image();               // a copy of what is there; waits for the piece under way
  [[nodiscard]] std::size_t bytes() const noexcept;  // on the GPU

 private:
  [[nodiscard]] std::size_t tilesIn(double most_s) const noexcept;
  [[nodiscard]] std::uint32_t coarsest(const Camera& camera) const noexcept;
  void record(const TileBatch& batch);
  void finished();

  gpu::Gpu& gpu_;
  gpu::Transfer& transfer_;
  const BrickPool& pool_;
  const BrickBoundsPass& bounds_;
  std::unique_ptr<CellTree> surface_, other_;  // the second one is null where it is not drawn
  std::vector<std::uint32_t> constants_;       // of the kernel
  std::unique_ptr<PoolKernel> kernel_;
  DrawStyle style_;
  layout::DrawPush push_{};
  PictureTiles tiles_;
  std::vector<std::uint32_t> changed_;  // bricks, since the last piece
  HostList<std::uint32_t> tile_list_;
  HostList<layout::DrawExtras> extras_;
  std::optional<gpu::Buffer> pixels_;
  gpu::Commands commands_;
  bool in_flight_ = false;
  bool showable_ = false;            // all pixels are of this camera
  std::uint64_t version_ = 0;        // of the volume, at the last change
  std::uint64_t shown_version_ = 0;  // of which all is drawn
  std::uint64_t pieces_ = 0;
  std::size_t in_flight_tiles_ = 0;
  Stopwatch since_submit_;
  double tile_s_;  // device time of a tile, of the last pieces
};

}  // namespace palpate
