// SPDX-License-Identifier: Apache-2.0
#include "engine/passes/brick_bounds_pass.hpp"

#include <algorithm>
#include <span>

namespace palpate {
namespace {

std::uint32_t groupsFor(std::size_t bricks, std::size_t group) {
  return static_cast<std::uint32_t>((bricks + group - 1) / group);
}

}  // namespace

BrickBoundsPass::BrickBoundsPass(gpu::Gpu& gpu, const BrickPool& pool)
    : gpu_(gpu),
      pool_(pool),
      all_(gpu, "brick_bounds", pool, BOUNDS_BINDINGS, sizeof(layout::BoundsPush), {BOUNDS_GROUP}),
      bounds_(gpu, "brick bounds", pool.brickCount() * sizeof(layout::BrickBounds), gpu::MemoryKind::kDevice),
      commands_(gpu, "brick bounds", 1) {}

void BrickBoundsPass::makeKernels() {
  if (!listed_)
    listed_.emplace(gpu_, "brick_bounds", pool_, BOUNDS_BINDINGS, sizeof(layout::BoundsPush),
                    std::vector<std::uint32_t>{BOUNDS_GROUP_LISTED});
  static_cast<void>(listed_->get());
}

void BrickBoundsPass::run() {
  const layout::BoundsPush push{pool_.domain(), static_cast<layout::uint>(pool_.brickCount()), 0};
  commands_.begin();
  // Neither the list nor its results are used, but every binding must have a buffer.
  commands_.dispatch(all_.get(), poolBindings(pool_, {&bounds_, &bounds_, &bounds_}), gpu::pushBytes(push),
                     gpu::Groups::folded(groupsFor(pool_.brickCount(), BOUNDS_GROUP), GROUPS_PER_ROW));
  commands_.run();
}

void BrickBoundsPass::record(gpu::Commands& commands, const gpu::Buffer& tasks, std::uint32_t count,
                             const gpu::Buffer& results) {
  const layout::BoundsPush push{pool_.domain(), count, 1};
  makeKernels();
  commands.dispatch(listed_->get(), poolBindings(pool_, {&bounds_, &tasks, &results}), gpu::pushBytes(push),
                    gpu::Groups::folded(groupsFor(std::max(count, 1U), BOUNDS_GROUP_LISTED), GROUPS_PER_ROW));
}

std::vector<layout::BrickBounds> BrickBoundsPass::read(gpu::Transfer& transfer) const {
  std::vector<layout::BrickBounds> bounds(pool_.brickCount());
  transfer.download(bounds_, std::as_writable_bytes(std::span(bounds)));
  return bounds;
}

}  // namespace palpate
