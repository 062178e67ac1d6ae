// SPDX-License-Identifier: Apache-2.0
#include "engine/passes/pool_volume.hpp"

namespace palpate {

Volume volumeOf(const BrickPool& pool, gpu::Transfer& transfer, const VolumeFacts& facts) {
  const Vec3i counts = pool.brickCounts();
  return Volume::fromBricks(pool.size(), pool.lattice(), facts, [&](const Vec3i& brick, float* values) {
    const auto index = (static_cast<std::size_t>(brick.z()) * counts.y() + brick.y()) * counts.x() + brick.x();
    return pool.readBrick(transfer, index, values);
  });
}

}  // namespace palpate
