// SPDX-License-Identifier: Apache-2.0
// engine/field/surface_cells.hpp: the cells of a volume that its isosurface crosses, each with its loops
// (cell_loops.hpp). Cells reach one voxel beyond the domain on each side, where everything is background. Private to
// engine/field. Any thread, while nobody changes the volume.
#pragma once

#include <array>
#include <cstdint>
#include <unordered_map>
#include <vector>

#include "engine/field/cell_loops.hpp"
#include "engine/field/volume.hpp"

namespace palpate {

struct SurfaceCell {
  Vec3i at = Vec3i::Zero();          // its first corner [voxel], from -1 on
  std::array<float, 8> densities{};  // at its corners; undefined outside the domain
  std::uint8_t inside = 0;           // a bit for each corner above the isovalue
  std::uint8_t joined = 0;           // a bit for each ambiguous face on which inside corners are joined
  CellLoops loops;
  std::uint32_t first_vertex = 0;  // number of the first loop's vertex; the other loops follow
};

class SurfaceCells {
 public:
  SurfaceCells(const Volume& volume, float isovalue);

  [[nodiscard]] const std::vector<SurfaceCell>& all() const noexcept { return cells_; }
  [[nodiscard]] const SurfaceCell& at(const Vec3i& cell) const { return cells_[index(cell)]; }  // a crossed cell only
  [[nodiscard]] const SurfaceCell* find(
      const Vec3i& cell) const;  // from -1 on along each axis; null: it is not crossed
  [[nodiscard]] std::uint32_t vertexCount() const noexcept { return vertex_count_; }  // one for each loop

 private:
  [[nodiscard]] std::uint64_t key(const Vec3i& cell) const noexcept;
  [[nodiscard]] std::uint32_t index(const Vec3i& cell) const { return by_place_.at(key(cell)); }
  void collect(const Volume& volume, float isovalue);
  void partDoubleLoops();

  Vec3i size_;
  std::vector<SurfaceCell> cells_;
  std::unordered_map<std::uint64_t, std::uint32_t> by_place_;
  std::uint32_t vertex_count_ = 0;
};

}  // namespace palpate
