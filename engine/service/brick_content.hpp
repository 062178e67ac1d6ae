// SPDX-License-Identifier: Apache-2.0
// engine/service/brick_content.hpp: a copy of a brick's densities, for undo, replay and savers. Any thread.
#pragma once

#include <cstdint>
#include <vector>

namespace palpate {

struct BrickContent {
  std::uint32_t brick = 0;    // linear page index (BrickGrid::index)
  std::vector<float> values;  // 512, i fastest, outside the domain as Volume::readBrick; or 1 if constant
};

}  // namespace palpate
