// SPDX-License-Identifier: Apache-2.0
// engine/service/isovalue_change.hpp: samples for another isovalue, made in portions beside those of the present one,
// so that windows go out in between and the servo can go over from one to the other.
//
// A brick gets its slot only with the portion that computes it: so a window never shows samples that are not there yet.
// Edits may come between portions; whoever applies them counts the bricks of both isovalues as active from the start
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
  // `bounds`: of every brick, as they are. Store and pass outlive this. Cost: a look at every brick. Throws
  // Error(kOutOfMemory) if the budget has no room for what `to` needs besides; then nothing has changed.
  IsovalueChange(SampleStore& store, GradientPass& gradient, const BrickGrid& grid,
                 std::span<const layout::BrickBounds> bounds, float to);

  // Computes the samples of up to `most` bricks. Blocks. Returns whether all are there. Throws Error(kOutOfMemory) if
  // edits have taken the room since; what was computed stays until dropInactive().
  bool gather(std::size_t most);

 private:
  SampleStore& store_;
  GradientPass& gradient_;
  BrickGrid grid_;
  std::vector<std::uint32_t> missing_;  // the next ones last
};

// Frees the slots of bricks that neither isovalue needs. Cost: a look at every brick.
void dropInactive(SampleStore& store, const BrickGrid& grid, std::span<const layout::BrickBounds> bounds,
                  const layout::IsovaluePair& isovalues);

}  // namespace palpate
