// SPDX-License-Identifier: Apache-2.0
// engine/service/isovalue_change.hpp: computes the samples of another isovalue in portions, while those of the present
// one stay. Windows go out between portions, and the servo can go over from one isovalue to the other.
//
// A brick gets its slot only with the portion that computes it. So a window never shows samples that are not there yet.
// Edits may come between portions. From the start of the change they must count the bricks of both isovalues as active
// (Editor::setIsovalues). Thread: the Gpu's.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "engine/bricks/brick_reach.hpp"
#include "engine/passes/gradient_pass.hpp"
#include "engine/passes/sample_store.hpp"
#include "shaders/brick_pool.layout.h"

namespace palpate {

class IsovalueChange {
 public:
  // `bounds`: the present bounds of every brick. `to`: the new isovalue [density]. Store and pass must outlive this.
  // Cost: one test for every brick. Throws Error(kOutOfMemory) if the budget has no room for the additional samples
  // that `to` needs; then nothing has changed.
  IsovalueChange(SampleStore& store, GradientPass& gradient, const BrickGrid& grid,
                 std::span<const layout::BrickBounds> bounds, float to);

  // Computes the samples of up to `most` bricks. Blocks. Returns whether all are there. Throws Error(kOutOfMemory) if
  // edits have taken the room since; the samples computed so far stay until dropInactive().
  bool gather(std::size_t most);

 private:
  SampleStore& store_;
  GradientPass& gradient_;
  BrickGrid grid_;
  std::vector<std::uint32_t> missing_;  // bricks to compute, taken from the end
};

// Frees the slots of bricks that neither isovalue needs. Cost: one test for every brick.
void dropInactive(SampleStore& store, const BrickGrid& grid, std::span<const layout::BrickBounds> bounds,
                  const layout::IsovaluePair& isovalues);

}  // namespace palpate
