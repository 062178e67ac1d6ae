// SPDX-License-Identifier: Apache-2.0
// engine/files/raw_block.hpp: reads values that a file holds in the layout of memory. They go straight into the
// volume's bricks, a row of bricks at a time. So the whole set of values is never in memory twice. Private to
// engine/files.
#pragma once

#include <cstdint>
#include <functional>
#include <string>

#include "engine/field/raw_values.hpp"
#include "engine/field/value_type.hpp"
#include "engine/field/volume.hpp"

namespace palpate {

// Where the first value lies; the others follow, i fastest.
struct RawBlock {
  std::string path;
  std::uint64_t offset = 0;  // [byte]
  bool swapped = false;      // the file's byte order is not the machine's
};

// The layers of a volume of `size` such values, for buildGridByLayers. Each value becomes float(value * slope +
// intercept), as in rawBricks, which also says what `rounded` is. Memory: 64 rows of voxels for each thread. Throws
// std::system_error if the file cannot be opened; the layers throw it if the file cannot be read or ends early.
[[nodiscard]] std::function<Volume::BrickSource(int bk)> layersOf(const RawBlock& block, ValueType type,
                                                                  const Vec3i& size, double slope, double intercept,
                                                                  RoundedNumbers* rounded = nullptr);

}  // namespace palpate
