// SPDX-License-Identifier: Apache-2.0
#include "engine/draw/cell_tree.hpp"

#include <algorithm>

namespace palpate {
namespace {

constexpr std::size_t kWordBytes = sizeof(std::uint32_t);
constexpr std::size_t kBlockBytes = CELL_WORDS_OF_BRICK * kWordBytes;  // of a brick
constexpr std::size_t kSpareSlots = 256;

std::uint32_t groupsOf(std::size_t count) {
  return static_cast<std::uint32_t>((count + CELL_GROUP - 1) / CELL_GROUP);
}

}  // namespace

std::uint32_t cellTreeLevels(const layout::PoolDomain& domain) noexcept {
  const layout::uint longest = std::max({domain.bricks_x, domain.bricks_y, domain.bricks_z});
  std::uint32_t levels = 1;
  while (levels < CELL_TREE_LEVELS && layout::cellNodesAlong(longest, levels) > 2) ++levels;
  return levels;
}

CellTree::CellTree(gpu::Gpu& gpu, gpu::Transfer& transfer, const BrickPool& pool, const BrickBoundsPass& bounds,
                   float isovalue)
    : gpu_(gpu),
      transfer_(transfer),
      pool_(pool),
      bounds_(bounds),
      isovalue_(isovalue),
      levels_(cellTreeLevels(pool.domain())),
      slots_kernel_(gpu, "cell_slots", pool, CELL_BINDINGS, sizeof(layout::CellTreePush)),
      blocks_kernel_(gpu, "cell_blocks", pool, CELL_BINDINGS, sizeof(layout::CellTreePush)),
      nodes_kernel_(gpu, "cell_nodes", pool, CELL_BINDINGS, sizeof(layout::CellTreePush)),
      list_(gpu, "bricks of the cell tree", 1),
      commands_(gpu, "cell tree", kMostDispatches) {
  const std::size_t words = layout::cellLevelBegin(pool.domain(), levels_ + 1);
  tree_.emplace(gpu, "cell tree", words * kWordBytes, gpu::MemoryKind::kDevice);
  std::vector<std::uint32_t> empty(1 + pool.brickCount(), NO_SLOT);
  empty.front() = 0;
  transfer.upload(std::as_bytes(std::span(empty)), *tree_);
  blocks_.emplace(gpu, "blocks of cells", kBlockBytes, gpu::MemoryKind::kDevice);  // there must be something to bind
  commands_.begin();
  recordSlots(commands_, pool.brickCount(), false);
  commands_.run();
  slots_at_most_ = slotsInUse();
  reserve(0);
  commands_.begin();
  recordBlocks(commands_, pool.brickCount(), false);
  recordNodes(commands_, {Vec3i::Zero(), pool.grid().counts() - Vec3i::Ones()});
  commands_.run();
}

std::uint32_t CellTree::slotsInUse() const {
  std::uint32_t slots = 0;
  transfer_.download(*tree_, std::as_writable_bytes(std::span(&slots, 1)));
  return slots;
}

void CellTree::reserve(std::size_t bricks) {
  if ((slots_at_most_ + bricks) * kBlockBytes <= blocks_->bytes()) return;
  slots_at_most_ = slotsInUse();
  const std::size_t needed = slots_at_most_ + bricks;
  if (needed * kBlockBytes <= blocks_->bytes()) return;
  gpu::Buffer larger(gpu_, "blocks of cells", (needed + needed / 4 + kSpareSlots) * kBlockBytes,
                     gpu::MemoryKind::kDevice);
  commands_.begin();
  commands_.copy(*blocks_, 0, larger, 0, blocks_->bytes());
  commands_.run();
  blocks_ = std::move(larger);
}

void CellTree::record(gpu::Commands& commands, std::span<const std::uint32_t> bricks) {
  if (bricks.empty()) return;
  list_.write(bricks);
  slots_at_most_ += bricks.size();
  const BrickGrid grid = pool_.grid();
  NodeBox box{grid.brick(bricks.front()), grid.brick(bricks.front())};
  for (const std::uint32_t brick : bricks) {
    box.first = box.first.cwiseMin(grid.brick(brick));
    box.last = box.last.cwiseMax(grid.brick(brick));
  }
  recordSlots(commands, bricks.size(), true);
  recordBlocks(commands, bricks.size(), true);
  recordNodes(commands, box);
}

layout::CellTreePush CellTree::push(std::size_t count, bool listed) const noexcept {
  layout::CellTreePush push{};
  push.domain = pool_.domain();
  push.isovalue = isovalue_;
  push.count = static_cast<layout::uint>(count);
  push.listed = listed ? 1 : 0;
  return push;
}

std::vector<const gpu::Buffer*> CellTree::bindings() const {
  return poolBindings(pool_, {&bounds_.bounds(), &*tree_, &*blocks_, &list_.buffer()});
}

void CellTree::recordSlots(gpu::Commands& commands, std::size_t count, bool listed) {
  const layout::CellTreePush push = this->push(count, listed);
  commands.dispatch(slots_kernel_.get(), bindings(), gpu::pushBytes(push),
                    gpu::Groups::folded(groupsOf(count), GROUPS_PER_ROW));
  commands.barrier();
}

void CellTree::recordBlocks(gpu::Commands& commands, std::size_t count, bool listed) {
  const layout::CellTreePush push = this->push(count, listed);
  commands.dispatch(blocks_kernel_.get(), bindings(), gpu::pushBytes(push),
                    gpu::Groups::folded(static_cast<std::uint32_t>(count), GROUPS_PER_ROW));
  commands.barrier();
}

void CellTree::recordNodes(gpu::Commands& commands, const NodeBox& box) {
  for (std::uint32_t level = 1; level <= levels_; ++level) {
    const int bricks = 1 << (2 * level);  // of a node, along an axis
    const Vec3i first = box.first / bricks, size = box.last / bricks - first + Vec3i::Ones();
    layout::CellTreePush push = this->push(static_cast<std::size_t>(size.prod()), false);
    push.level = level;
    push.first_x = static_cast<layout::uint>(first.x());
    push.first_y = static_cast<layout::uint>(first.y());
    push.first_z = static_cast<layout::uint>(first.z());
    push.size_x = static_cast<layout::uint>(size.x());
    push.size_y = static_cast<layout::uint>(size.y());
    push.size_z = static_cast<layout::uint>(size.z());
    commands.dispatch(nodes_kernel_.get(), bindings(), gpu::pushBytes(push),
                      gpu::Groups::folded(groupsOf(push.count), GROUPS_PER_ROW));
    commands.barrier();
  }
}

}  // namespace palpate
