// SPDX-License-Identifier: Apache-2.0
// engine/journal/kept_bricks.hpp: bricks of a volume as bytes, as a checkpoint and the beginning of a journal hold them
// (docs/journal.md). Any thread.
#pragma once

#include <cstdint>
#include <string_view>
#include <vector>

#include "engine/bricks/brick_grid.hpp"
#include "engine/field/volume.hpp"
#include "engine/journal/byte_stream.hpp"

namespace palpate {

// Each brick has one density, if it is the same everywhere, or 512.
struct KeptBricks {
  std::vector<std::uint32_t> bricks;  // page indices, ascending
  std::vector<float> densities;       // of all, one after the other
  std::vector<std::uint32_t> counts;  // how many of them each brick has
};

// Writes what a brick holds now. Cost: 2 KiB at most.
void addBrick(ByteWriter& out, const Volume& volume, const BrickGrid& grid, std::uint32_t brick);
// Reads so many bricks, in addition to those that are there. False: they are malformed or not ascending, and what was
// read is of no use.
[[nodiscard]] bool getBricks(ByteReader& in, std::uint32_t count, KeptBricks& bricks);

[[nodiscard]] bool fit(const KeptBricks& bricks, const Volume& volume);
void putBricks(const KeptBricks& bricks, Volume& volume);  // which they fit

}  // namespace palpate
