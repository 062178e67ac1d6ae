// SPDX-License-Identifier: Apache-2.0
// engine/files/raw_block.hpp: values that lie in a file as they lie in memory, read a row of bricks at a time straight
// into a volume's bricks, so that they are never all in memory twice. Private to engine/files.
#pragma once

#include <cstdint>
#include <functional>
#include <string>

#include "engine/field/value_type.hpp"
#include "engine/field/volume.hpp"

namespace palpate {

// Where the first value lies; the others follow, i fastest.
struct RawBlock {
  std::string path;
  std::uint64_t offset = 0;  // [byte]
  bool swapped = false;      // against the machine's byte order
};

// The layers of a volume of `size` such values, for buildGridByLayers, each value made float(value * slope + intercept)
// as rawBricks does. Memory: 64 rows of voxels a thread. Throws std::system_error: the file cannot be opened, or (from
// the layers) read or ends early.
[[nodiscard]] std::function<Volume::BrickSource(int bk)> layersOf(const RawBlock& block, ValueType type,
                                                                  const Vec3i& size, double slope, double intercept);

}  // namespace palpate
