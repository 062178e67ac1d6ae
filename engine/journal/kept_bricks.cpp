// SPDX-License-Identifier: Apache-2.0
#include "engine/journal/kept_bricks.hpp"

#include <array>
#include <cstring>
#include <span>

#include "engine/field/brick_values.hpp"

namespace palpate {

void addBrick(ByteWriter& out, const Volume& volume, const BrickGrid& grid, std::uint32_t brick) {
  std::array<float, kBrickVoxels> values{};
  const bool is_constant = volume.readBrick(grid.brick(brick), values.data()) || holdOneValue(values);
  const std::span<const float> kept = std::span(values).first(is_constant ? 1 : kBrickVoxels);
  out.add(brick);
  out.add(static_cast<std::uint32_t>(kept.size()));
  out.addRaw({reinterpret_cast<const char*>(kept.data()), kept.size_bytes()});
}

bool getBricks(ByteReader& in, std::uint32_t count, KeptBricks& bricks) {
  for (std::uint32_t i = 0; i < count; ++i) {
    std::uint32_t brick = 0, values = 0;
    in.get(brick);
    in.get(values);
    if (values != 1 && values != kBrickVoxels) return false;
    const std::string_view bytes = in.getRaw(values * sizeof(float));
    if (!in.good() || (!bricks.bricks.empty() && brick <= bricks.bricks.back())) return false;
    bricks.bricks.push_back(brick);
    bricks.counts.push_back(values);
    const std::size_t before = bricks.densities.size();
    bricks.densities.resize(before + values);
    std::memcpy(bricks.densities.data() + before, bytes.data(), bytes.size());
  }
  return true;
}

bool fit(const KeptBricks& bricks, const Volume& volume) {
  const BrickGrid grid{volume.size(), volume.lattice().spacing_m};
  return bricks.bricks.empty() || bricks.bricks.back() < grid.brickCount();
}

void putBricks(const KeptBricks& bricks, Volume& volume) {
  const BrickGrid grid{volume.size(), volume.lattice().spacing_m};
  std::span<const float> rest(bricks.densities);
  for (std::size_t i = 0; i < bricks.bricks.size(); ++i) {
    putBrick(volume, grid.brick(bricks.bricks[i]), rest.first(bricks.counts[i]));
    rest = rest.subspan(bricks.counts[i]);
  }
}

}  // namespace palpate
