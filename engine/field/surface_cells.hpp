// SPDX-License-Identifier: Apache-2.0
// engine/field/surface_cells.hpp: the cells of a volume that its isosurface crosses. Cells reach one voxel beyond the
// domain on each side, where everything is background. Private to engine/field. Any thread, while nobody changes the
// volume.
#pragma once

#include <array>
#include <cstdint>
#include <unordered_map>
#include <vector>

#include "engine/field/volume.hpp"

namespace palpate {

struct SurfaceCell {
  Vec3i at = Vec3i::Zero();          // its first corner [voxel], from -1 on
  std::array<float, 8> densities{};  // at its corners; undefined outside the domain
  std::uint8_t inside = 0;           // a bit for each corner above the isovalue
  std::uint8_t joined = 0;           // a bit for each ambiguous face on which inside corners are joined
};

class SurfaceCells {
 public:
  SurfaceCells(const Volume& volume, float isovalue);

  [[nodiscard]] const std::vector<SurfaceCell>& all() const noexcept { return cells_; }
  [[nodiscard]] std::size_t indexOf(const Vec3i& cell) const { return by_place_.at(key(cell)); }  // of a crossed one

 private:
  [[nodiscard]] std::uint64_t key(const Vec3i& cell) const noexcept;
  void collect(const Volume& volume, float isovalue);

  Vec3i size_;
  std::vector<SurfaceCell> cells_;
  std::unordered_map<std::uint64_t, std::uint32_t> by_place_;
};

}  // namespace palpate
