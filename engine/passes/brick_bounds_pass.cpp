// SPDX-License-Identifier: Apache-2.0
#include "engine/passes/brick_bounds_pass.hpp"

#include <span>

#include "engine/passes/pool_kernel.hpp"

namespace palpate {

BrickBoundsPass::BrickBoundsPass(gpu::Gpu& gpu, const BrickPool& pool)
    : pool_(pool),
      kernel_(makePoolKernel(gpu, "brick_bounds", pool, BOUNDS_BINDINGS, sizeof(layout::BoundsPush))),
      bounds_(gpu, "brick bounds", pool.brickCount() * sizeof(layout::BrickBounds), gpu::MemoryKind::kDevice),
      commands_(gpu, "brick bounds", 1) {}

void BrickBoundsPass::run() {
  const layout::BoundsPush push{pool_.domain(), static_cast<layout::uint>(pool_.brickCount())};
  const auto groups = static_cast<std::uint32_t>((pool_.brickCount() + BOUNDS_GROUP - 1) / BOUNDS_GROUP);
  commands_.begin();
  commands_.dispatch(kernel_, poolBindings(pool_, {&bounds_}), gpu::pushBytes(push),
                     gpu::Groups::folded(groups, GROUPS_PER_ROW));
  commands_.run();
}

std::vector<layout::BrickBounds> BrickBoundsPass::read(gpu::Transfer& transfer) const {
  std::vector<layout::BrickBounds> bounds(pool_.brickCount());
  transfer.download(bounds_, std::as_writable_bytes(std::span(bounds)));
  return bounds;
}

}  // namespace palpate
