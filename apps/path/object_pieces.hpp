// SPDX-License-Identifier: Apache-2.0
// apps/path/object_pieces.hpp: the connected pieces of the object in a volume, largest first, with their sizes.
//
// A piece is a set of samples above the isovalue that are connected along the axes of the lattice (6-neighbours). Two
// bodies that only touch at an edge or a corner are two pieces. Set-up code, any thread while the field does not
// change. Cost: one pass over the field's blocks, about a second for 10^8 samples. Memory: 12 bytes for each run of
// object samples along the first axis.
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "apps/path/surface_search.hpp"

namespace palpate {

struct ObjectPiece {
  std::int64_t voxels = 0;      // samples
  Vec3i first = Vec3i::Zero();  // of the bounding box [voxel]
  Vec3i last = Vec3i::Zero();   // inclusive [voxel]
};

class ObjectPieces {
 public:
  explicit ObjectPieces(const SurfaceField& field);

  // The largest first; pieces of equal size in the order in which they come in the volume.
  [[nodiscard]] const std::vector<ObjectPiece>& all() const noexcept { return pieces_; }

  // The index of the piece that a sample belongs to; empty: background, or outside the volume.
  [[nodiscard]] std::optional<std::size_t> pieceOf(const Vec3i& voxel) const;
  // The index of the piece that a point of the surface belongs to: the piece of the nearest object sample of its cell.
  [[nodiscard]] std::optional<std::size_t> pieceAt(const Vec3& surface_W) const;

  // At most `count` background samples next to samples of the piece along the first axis, spread evenly over the piece.
  // None if the piece ends only at the volume's border.
  struct Entry {
    Vec3i outside = Vec3i::Zero();  // [voxel]
    int sense = 1;                  // +1 or -1: direction to the piece along the first axis
  };
  [[nodiscard]] std::vector<Entry> entries(std::size_t piece, std::size_t count) const;

 private:
  struct Run {
    std::int32_t begin = 0, end = 0;  // along the first axis, [begin, end) [voxel]
    std::uint32_t piece = 0;          // while pieces are joined: another run of the same one
  };
  void findRuns(const SurfaceField& field);
  void joinRows();
  void joinRows(std::size_t row, std::size_t other);
  void numberPieces();
  std::uint32_t rootOf(std::uint32_t run);
  [[nodiscard]] std::size_t rowOf(int j, int k) const {
    return static_cast<std::size_t>(j) + static_cast<std::size_t>(k) * static_cast<std::size_t>(size_.y());
  }

  Vec3i size_;
  Lattice lattice_;
  std::vector<Run> runs_;
  std::vector<std::uint32_t> first_, count_;  // of each row's runs
  std::vector<ObjectPiece> pieces_;
};

}  // namespace palpate
