// SPDX-License-Identifier: Apache-2.0
#include "engine/field/surface_cells.hpp"

#include <optional>

#include "engine/field/cell_loops.hpp"
#include "engine/field/field_grid.hpp"

namespace palpate {
namespace {

// On an ambiguous face, the inside corners are joined if the saddle of the trilinear field lies above the isovalue
// (Nielson and Hamann, IEEE Visualization 1991). Both cells of a face read the same four densities, so they agree.
std::uint8_t joinedFaces(const SurfaceCell& cell, float isovalue) {
  unsigned joined = 0;
  for (int face = 0; face < 6; ++face) {
    if (!isAmbiguous(cell.inside, face)) continue;
    const auto corners = faceCorners(face);
    const auto above = [&](std::size_t n) {
      return static_cast<double>(cell.densities[static_cast<std::size_t>(corners[n])]) - isovalue;
    };
    const double first = above(0) * above(2);
    const double second = above(1) * above(3);
    if (above(0) > 0 ? first > second : second > first) joined |= 1U << face;
  }
  return static_cast<std::uint8_t>(joined);
}

// The densities of a volume, with background around it.
class Densities {
 public:
  Densities(const Volume& volume, float isovalue)
      : size_(volume.size()), isovalue_(isovalue), field_(*volume.grid().field) {}

  // Whether all voxels of a brick are inside (true) or all outside (false) the object; empty if neither is certain. The
  // brick may lie outside the domain.
  [[nodiscard]] std::optional<bool> sideOf(const Vec3i& brick) {
    const Vec3i first = brick * kBrickSize;
    if ((first.array() < 0).any() || (first.array() >= size_.array()).any()) return false;
    const std::optional<float> constant = field_.constantOf(brick);
    if (!constant) return std::nullopt;
    return *constant > isovalue_;
  }

  [[nodiscard]] bool holds(const Vec3i& voxel) const {
    return (voxel.array() >= 0).all() && (voxel.array() < size_.array()).all();
  }
  [[nodiscard]] const Vec3i& size() const { return size_; }
  void read(const Vec3i& first, const Vec3i& size, float* values) const { field_.readBox(first, size, values); }

 private:
  Vec3i size_;
  float isovalue_;
  const FieldGrid& field_;
};

// Whether the surface may cross a cell that begins in the brick. Such cells reach into the next bricks.
bool mayBeCrossed(Densities& densities, const Vec3i& brick) {
  std::optional<bool> side = densities.sideOf(brick);
  if (!side) return true;
  for (int n = 1; n < 8; ++n) {
    if (densities.sideOf(brick + Vec3i(n & 1, n >> 1 & 1, n >> 2)) != side) return true;
  }
  return false;
}

// The densities at the corners of a brick's cells, read once.
class Block {
 public:
  Block(Densities& densities, float isovalue) : densities_(densities), isovalue_(isovalue) {}

  void read(const Vec3i& first, const Vec3i& last) {
    first_ = first;
    const Vec3i inside = first.cwiseMax(0);
    const Vec3i size = (last + Vec3i::Ones()).cwiseMin(densities_.size() - Vec3i::Ones()) - inside + Vec3i::Ones();
    std::array<float, kWide * kWide * kWide> box;
    densities_.read(inside, size, box.data());
    const float* next = box.data();
    for (int k = first.z(); k <= last.z() + 1; ++k) {
      for (int j = first.y(); j <= last.y() + 1; ++j) {
        for (int i = first.x(); i <= last.x() + 1; ++i) {
          const std::size_t n = place({i, j, k});
          const bool holds = densities_.holds({i, j, k});
          values_[n] = holds ? *next++ : 0.0F;
          inside_[n] = holds && values_[n] > isovalue_ ? 1 : 0;
        }
      }
    }
  }

  [[nodiscard]] std::uint8_t insideOf(const Vec3i& at) const {
    const std::size_t n = place(at);
    unsigned inside = 0;
    for (std::size_t corner = 0; corner < 8; ++corner)
      inside |= static_cast<unsigned>(inside_[n + kCorners[corner]]) << corner;
    return static_cast<std::uint8_t>(inside);
  }

  [[nodiscard]] SurfaceCell cell(const Vec3i& at, std::uint8_t inside) const {
    SurfaceCell cell;
    cell.at = at;
    cell.inside = inside;
    const std::size_t n = place(at);
    for (std::size_t corner = 0; corner < 8; ++corner) cell.densities[corner] = values_[n + kCorners[corner]];
    cell.joined = joinedFaces(cell, isovalue_);
    return cell;
  }

 private:
  static constexpr std::size_t kWide = kBrickSize + 1;
  static constexpr std::array<std::size_t, 8> kCorners = {
      0, 1, kWide, kWide + 1, kWide* kWide, kWide* kWide + 1, kWide* kWide + kWide, kWide* kWide + kWide + 1};

  [[nodiscard]] std::size_t place(const Vec3i& voxel) const {
    const auto at = (voxel - first_).cast<std::size_t>();
    return (at.z() * kWide + at.y()) * kWide + at.x();
  }

  Densities& densities_;
  float isovalue_;
  Vec3i first_ = Vec3i::Zero();
  std::array<float, kWide * kWide * kWide> values_{};
  std::array<std::uint8_t, kWide * kWide * kWide> inside_{};
};

}  // namespace

std::uint64_t SurfaceCells::key(const Vec3i& cell) const noexcept {
  const Eigen::Matrix<std::uint64_t, 3, 1> at = (cell + Vec3i::Ones()).cast<std::uint64_t>();
  const Eigen::Matrix<std::uint64_t, 3, 1> counts = (size_ + Vec3i::Ones()).cast<std::uint64_t>();
  return (at.z() * counts.y() + at.y()) * counts.x() + at.x();
}

SurfaceCells::SurfaceCells(const Volume& volume, float isovalue) : size_(volume.size()) {
  collect(volume, isovalue);
  by_place_.reserve(cells_.size());
  for (std::size_t n = 0; n < cells_.size(); ++n) by_place_.emplace(key(cells_[n].at), static_cast<std::uint32_t>(n));
}

void SurfaceCells::collect(const Volume& volume, float isovalue) {
  Densities densities(volume, isovalue);
  const Vec3i counts = volume.brickCount();
  Block block(densities, isovalue);
  for (int bk = -1; bk < counts.z(); ++bk) {
    for (int bj = -1; bj < counts.y(); ++bj) {
      for (int bi = -1; bi < counts.x(); ++bi) {
        const Vec3i brick(bi, bj, bk);
        if (!mayBeCrossed(densities, brick)) continue;
        // In a brick before the domain, only the last cells reach into the domain.
        const Vec3i first = (brick * kBrickSize).cwiseMax(-1);
        const Vec3i last = (brick * kBrickSize + Vec3i::Constant(kBrickSize - 1)).cwiseMin(size_ - Vec3i::Ones());
        block.read(first, last);
        for (int k = first.z(); k <= last.z(); ++k) {
          for (int j = first.y(); j <= last.y(); ++j) {
            for (int i = first.x(); i <= last.x(); ++i) {
              const std::uint8_t inside = block.insideOf({i, j, k});
              if (inside != 0 && inside != 0xff) cells_.push_back(block.cell({i, j, k}, inside));
            }
          }
        }
      }
    }
  }
}

}  // namespace palpate
