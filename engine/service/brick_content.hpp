// SPDX-License-Identifier: Apache-2.0
// engine/service/brick_content.hpp: a copy of a brick's densities, for undo, replay and savers, and the moment to take
// it. Any thread.
#pragma once

#include <cstdint>
#include <functional>
#include <span>
#include <vector>

namespace palpate {

struct BrickContent {
  std::uint32_t brick = 0;    // linear page index (BrickGrid::index)
  std::vector<float> values;  // 512, i fastest, outside the domain as Volume::readBrick; or 1 if constant
};

// Gets the bricks that an edit may change, ascending, while they still hold what they did: a history keeps their
// content. What it throws ends the edit with nothing changed.
using BeforeChange = std::function<void(std::span<const std::uint32_t> bricks)>;

}  // namespace palpate
