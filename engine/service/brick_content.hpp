// SPDX-License-Identifier: Apache-2.0
// engine/service/brick_content.hpp: what a brick holds, as undo, replay and savers keep it. Any thread.
#pragma once

#include <cstdint>
#include <vector>

namespace palpate {

struct BrickContent {
  std::uint32_t brick = 0;    // linear page index (BrickGrid::index)
  std::vector<float> values;  // 512, i fastest, voxels outside the domain as Volume::readBrick gives them; or one
};

}  // namespace palpate
