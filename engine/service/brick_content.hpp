// SPDX-License-Identifier: Apache-2.0
// engine/service/brick_content.hpp: a copy of a brick's densities, for undo, replay and savers, and the callback in
// which a history takes such copies. Any thread.
#pragma once

#include <cstdint>
#include <functional>
#include <span>
#include <vector>

namespace palpate {

struct BrickContent {
  std::uint32_t brick = 0;    // linear page index (BrickGrid::index)
  std::vector<float> values;  // 512, i fastest, padded as Volume::readBrick pads; or 1 if constant
};

// Called with the bricks that an edit may change, in ascending order, before any of them changes. A history copies them
// here. An exception from it cancels the edit, and nothing has changed.
using BeforeChange = std::function<void(std::span<const std::uint32_t> bricks)>;

}  // namespace palpate
