// SPDX-License-Identifier: Apache-2.0
#include "engine/draw/drawing.hpp"

#include <algorithm>
#include <map>

#include "engine/bricks/brick_reach.hpp"
#include "engine/draw/draw_push.hpp"
#include "engine/draw/picture_image.hpp"

namespace palpate {
namespace {

constexpr double kFirstGuess_s = 50e-6;  // for a tile, before one was measured: a slow processor's
constexpr double kPiece_s = 4e-3;        // of a picture that is waited for
constexpr std::size_t kMostTiles = 4096;
constexpr double kMostCoarse_s = 0.02;  // of the first pixels of a picture

// Changed bricks that are projected one by one; more of them are taken four by four by four.
constexpr std::size_t kMostSingleBricks = 32;

}  // namespace

Drawing::Drawing(gpu::Gpu& gpu, gpu::Transfer& transfer, const BrickPool& pool, const BrickBoundsPass& bounds)
    : gpu_(gpu),
      transfer_(transfer),
      pool_(pool),
      bounds_(bounds),
      tile_list_(gpu, "tiles of the picture", kMostTiles),
      extras_(gpu, "planes of the picture", 1),
      commands_(gpu, "picture", 1 + 2 * CellTree::kMostDispatches),
      tile_s_(kFirstGuess_s) {
  commands_.timed(true);
}

Drawing::~Drawing() = default;

void Drawing::show(const Camera& camera, double isovalue, const DrawStyle& style, DrawOrder order) {
  checkStyle(style);
  const layout::DrawPush push = drawPush(pool_.domain(), pool_.lattice(), camera, isovalue);
  wait();
  // What is new is made first: where that fails, the former picture goes on.
  const auto newTree = [&](const std::unique_ptr<CellTree>& tree, double wanted) -> std::unique_ptr<CellTree> {
    if (tree && tree->isovalue() == static_cast<float>(wanted)) return nullptr;
    return std::make_unique<CellTree>(gpu_, transfer_, pool_, bounds_, static_cast<float>(wanted));
  };
  std::unique_ptr<CellTree> surface = newTree(surface_, isovalue);
  std::unique_ptr<CellTree> other = style.other_isovalue ? newTree(other_, *style.other_isovalue) : nullptr;
  std::vector<std::uint32_t> constants = {cellTreeLevels(pool_.domain()),
                                          static_cast<std::uint32_t>(style.clips.size()),
                                          static_cast<std::uint32_t>(style.slices.size()),
                                          style.other_isovalue ? 1U : 0U,
                                          style.occlusion ? 1U : 0U,
                                          style.normals ? 1U : 0U};
  std::unique_ptr<PoolKernel> kernel;
  if (!kernel_ || constants != constants_)
    kernel = std::make_unique<PoolKernel>(gpu_, "draw", pool_, DRAW_BINDINGS, sizeof(layout::DrawPush), constants);
  const std::size_t bytes =
      static_cast<std::size_t>(camera.width) * static_cast<std::size_t>(camera.height) * sizeof(layout::PicturePixel);
  std::optional<gpu::Buffer> pixels;
  if (!pixels_ || pixels_->bytes() != bytes) pixels.emplace(gpu_, "picture", bytes, gpu::MemoryKind::kDevice);

  if (surface) surface_ = std::move(surface);
  if (other || !style.other_isovalue) other_ = std::move(other);
  if (kernel) kernel_ = std::move(kernel);
  if (pixels) pixels_ = std::move(pixels);
  constants_ = std::move(constants);
  const layout::DrawExtras extras = drawExtras(pool_.lattice(), style);
  extras_.write(std::span(&extras, 1));
  push_ = push;
  style_ = style;
  tiles_.start(camera, order, coarsest(camera));
  showable_ = false;
}

void Drawing::changed(std::span<const ChangedBrick> bricks, std::uint64_t version) {
  version_ = version;
  if (!surface_) return;
  for (const ChangedBrick& changed : bricks) changed_.push_back(changed.brick);
  if (changed_.size() > 2 * pool_.brickCount()) sortUnique(changed_);
  const Vec3 reach = Vec3::Constant(style_.occlusion ? DRAW_OCCLUSION_REACH : DRAW_NORMAL_REACH);
  const BrickGrid grid = pool_.grid();
  const int together = bricks.size() > kMostSingleBricks ? 4 : 1;
  std::map<std::uint32_t, VoxelBox> hulls;
  for (const ChangedBrick& changed : bricks) {
    const Vec3i first = grid.brick(changed.brick) / together * together;
    const auto [at, is_new] = hulls.try_emplace(grid.index(first), changed.voxels);
    if (!is_new) at->second = hull(at->second, changed.voxels);
  }
  for (const auto& [first, box] : hulls)
    tiles_.changed(pool_.lattice(), box.first.cast<double>() - reach, box.last.cast<double>() + reach, version);
}

bool Drawing::poll() {
  if (in_flight_ && commands_.done()) finished();
  return !in_flight_;
}

bool Drawing::advance(double most_s) {
  if (!surface_ || (poll() && whole())) return true;
  if (in_flight_) return false;
  std::vector<std::uint32_t> reached;
  const BrickGrid grid = pool_.grid();
  sortUnique(changed_);
  for (const std::uint32_t brick : changed_) appendReached(grid, grid.box(brick), kBoundsReach, reached);
  sortUnique(reached);
  surface_->reserve(reached.size());
  if (other_) other_->reserve(reached.size());
  const TileBatch batch = tiles_.next(tilesIn(most_s));
  try {
    tile_list_.write(batch.tiles);
    commands_.begin();
    surface_->record(commands_, reached);
    if (other_) other_->record(commands_, reached);
    commands_.mark("tree");
    record(batch);
    commands_.mark("draw");
    commands_.hostBarrier();
    commands_.submit();
  } catch (...) {  // nothing of this batch is drawn
    tiles_.again();
    showable_ = false;
    throw;
  }
  changed_.clear();
  in_flight_ = true;
  in_flight_tiles_ = batch.tiles.size();
  since_submit_ = {};
  return false;
}

void Drawing::record(const TileBatch& batch) {
  if (batch.tiles.empty()) return;
  layout::DrawPush push = push_;
  push.first_tile = 0;
  push.tile_count = static_cast<layout::uint>(batch.tiles.size());
  push.grid = batch.grid.stride | batch.grid.x << 8U | batch.grid.y << 16U | batch.grid.square << 24U;
  const CellTree& other = other_ ? *other_ : *surface_;
  commands_.dispatch(kernel_->get(),
                     poolBindings(pool_, {&surface_->tree(), &surface_->blocks(), &other.tree(), &other.blocks(),
                                          &tile_list_.buffer(), &extras_.buffer(), &*pixels_}),
                     gpu::pushBytes(push), gpu::Groups::folded(push.tile_count, GROUPS_PER_ROW));
}

// Of a slow device every eighth pixel, so that a moving camera is followed.
std::uint32_t Drawing::coarsest(const Camera& camera) const noexcept {
  const double tiles = static_cast<double>(camera.width) * camera.height / (DRAW_TILE * DRAW_TILE);
  return tile_s_ * tiles / (4 * 4) > kMostCoarse_s ? 8 : 4;
}

std::size_t Drawing::tilesIn(double most_s) const noexcept {
  return std::clamp<std::size_t>(static_cast<std::size_t>(most_s / tile_s_), 1, kMostTiles);
}

// A piece may have met other rays than the one before it: a slow one counts at once, a fast one bit by bit.
void Drawing::finished() {
  in_flight_ = false;
  showable_ = tiles_.coarse();
  const auto stale = tiles_.oldestStale();
  shown_version_ = stale ? *stale - 1 : version_;
  ++pieces_;
  if (in_flight_tiles_ == 0) return;
  double seconds = since_submit_.seconds();
  for (const StageTime& stage : commands_.marks()) {
    if (stage.name == "draw") seconds = stage.seconds;
  }
  const double tile_s = std::max(seconds / static_cast<double>(in_flight_tiles_), 1e-9);
  tile_s_ = tile_s > tile_s_ ? tile_s : 0.7 * tile_s_ + 0.3 * tile_s;
}

void Drawing::wait() {
  if (!in_flight_) return;
  commands_.wait();
  finished();
}

void Drawing::finish(const std::function<void()>& between) {
  while (!advance(kPiece_s)) {
    wait();
    if (between) between();
  }
}

void Drawing::copyTo(std::vector<layout::PicturePixel>& pixels) {
  wait();
  pixels.resize(pixels_->bytes() / sizeof(layout::PicturePixel));
  transfer_.download(*pixels_, std::as_writable_bytes(std::span(pixels)));
}

RenderedImage Drawing::image() {
  std::vector<layout::PicturePixel> raw;
  copyTo(raw);
  return asImage(static_cast<int>(push_.size & 65535U), static_cast<int>(push_.size >> 16U), raw);
}

std::size_t Drawing::bytes() const noexcept {
  std::size_t bytes = pixels_ ? pixels_->bytes() : 0;
  if (surface_) bytes += surface_->bytes();
  if (other_) bytes += other_->bytes();
  return bytes;
}

}  // namespace palpate
