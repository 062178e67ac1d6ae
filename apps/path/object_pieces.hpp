// SPDX-License-Identifier: Apache-2.0
// apps/path/object_pieces.hpp: the connected pieces of the object in a volume: which is the largest, how large each is.
//
// A piece is a set of samples above the isovalue, each next to another of it along an axis of the lattice. Two bodies
// that only touch at an edge or a corner are two pieces. Set-up code, any thread while the field does not change. Cost:
// one pass over the field's blocks, and 12 bytes for each run of object along the first axis: a second for 10^8
// samples.
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "apps/path/surface_search.hpp"

namespace palpate {

struct ObjectPiece {
  std::int64_t voxels = 0;      // samples
  Vec3i first = Vec3i::Zero();  // of the box around them [voxel]
  Vec3i last = Vec3i::Zero();   // inclusive [voxel]
};

class ObjectPieces {
 public:
  explicit ObjectPieces(const SurfaceField& field);

  // The largest first; of two equal ones that which comes first in the volume.
  [[nodiscard]] const std::vector<ObjectPiece>& all() const noexcept { return pieces_; }

  // Which of them a sample belongs to; empty: to none, or it lies outside the volume.
  [[nodiscard]] std::optional<std::size_t> pieceOf(const Vec3i& voxel) const;
  // Which of them a point of the surface belongs to: that of the nearest object sample of its cell.
  [[nodiscard]] std::optional<std::size_t> pieceAt(const Vec3& surface_W) const;

  // Samples of background, each of which has one of the piece behind it along the first axis, in the sense that comes
  // with it: at most `count`, spread evenly over the piece. None where the piece ends at the border of the volume only.
  struct Entry {
    Vec3i outside = Vec3i::Zero();  // [voxel]
    int sense = 1;                  // +1 or -1: where along the first axis the piece is
  };
  [[nodiscard]] std::vector<Entry> entries(std::size_t piece, std::size_t count) const;

 private:
  struct Run {
    std::int32_t begin = 0, end = 0;  // along the first axis, end not included [voxel]
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
