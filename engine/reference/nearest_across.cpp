// SPDX-License-Identifier: Apache-2.0
#include "engine/reference/nearest_across.hpp"

#include <algorithm>
#include <cstdint>

namespace palpate::reference {
namespace {

constexpr std::uint8_t kInside = 1;
constexpr std::uint8_t kOutside = 2;

// The side of each voxel, with a border around the field that lies on neither side.
class Sides {
 public:
  Sides(const DenseField& field, const AcrossSearch& search) : border_(search.reach), size_(field.size + 2 * border_) {
    sides_.resize(static_cast<std::size_t>(size_.x()) * static_cast<std::size_t>(size_.y()) *
                  static_cast<std::size_t>(size_.z()));
    for (int k = 0; k < field.size.z(); ++k) {
      for (int j = 0; j < field.size.y(); ++j) {
        for (int i = 0; i < field.size.x(); ++i)
          sides_[place({i, j, k})] = field.at(i, j, k) > search.isovalue ? kInside : kOutside;
      }
    }
  }

  [[nodiscard]] std::size_t place(const Vec3i& voxel) const {
    const Vec3i at = voxel + border_;
    return static_cast<std::size_t>(at.x() + step(Vec3i(0, at.y(), at.z())));
  }
  // The step from a voxel's place to that of the voxel `shift` away.
  [[nodiscard]] std::ptrdiff_t step(const Vec3i& shift) const {
    return (static_cast<std::ptrdiff_t>(shift.z()) * size_.y() + shift.y()) * size_.x() + shift.x();
  }
  [[nodiscard]] std::uint8_t at(std::size_t place) const { return sides_[place]; }

 private:
  Vec3i border_, size_;
  std::vector<std::uint8_t> sides_;
};

// A voxel to look at, relative to the voxel whose distance is wanted.
struct Candidate {
  std::ptrdiff_t step = 0;
  float square = 0;
};

// All voxels of a box but its middle, the nearest first.
std::vector<Candidate> candidatesOf(const AcrossSearch& search, const Sides& sides) {
  const auto along = [&](int steps, int axis) {
    return static_cast<float>(steps * steps) * static_cast<float>(search.edge_square[axis]);
  };
  std::vector<Candidate> candidates;
  for (int k = -search.reach.z(); k <= search.reach.z(); ++k) {
    for (int j = -search.reach.y(); j <= search.reach.y(); ++j) {
      for (int i = -search.reach.x(); i <= search.reach.x(); ++i) {
        if (i == 0 && j == 0 && k == 0) continue;
        const float in_plane = along(i, 0) + along(j, 1);
        candidates.push_back({sides.step({i, j, k}), along(k, 2) + in_plane});
      }
    }
  }
  std::stable_sort(candidates.begin(), candidates.end(),
                   [](const Candidate& a, const Candidate& b) { return a.square < b.square; });
  return candidates;
}

// Blocks of voxels as large as the reach. If a block and all blocks around it lie on one side, no voxel of that block
// needs a search.
class Blocks {
 public:
  Blocks(const DenseField& field, const AcrossSearch& search, const Sides& sides)
      : edge_(search.reach.cwiseMax(1)), count_((field.size + edge_ - Vec3i::Ones()).cwiseQuotient(edge_)) {
    sides_.resize(static_cast<std::size_t>(count_.prod()));
    for (int k = 0; k < field.size.z(); ++k) {
      for (int j = 0; j < field.size.y(); ++j) {
        for (int i = 0; i < field.size.x(); ++i) {
          std::uint8_t& block = sides_[index(Vec3i(i, j, k).cwiseQuotient(edge_))];
          block = static_cast<std::uint8_t>(block | sides.at(sides.place({i, j, k})));
        }
      }
    }
  }

  [[nodiscard]] bool isFarFromSurface(const Vec3i& voxel) const {
    const Vec3i block = voxel.cwiseQuotient(edge_);
    const Vec3i first = (block - Vec3i::Ones()).cwiseMax(Vec3i::Zero());
    const Vec3i last = (block + Vec3i::Ones()).cwiseMin(count_ - Vec3i::Ones());
    unsigned found = 0;
    for (int k = first.z(); k <= last.z(); ++k) {
      for (int j = first.y(); j <= last.y(); ++j) {
        for (int i = first.x(); i <= last.x(); ++i) found |= sides_[index({i, j, k})];
      }
    }
    return found != (kInside | kOutside);
  }

 private:
  [[nodiscard]] std::size_t index(const Vec3i& block) const {
    return (static_cast<std::size_t>(block.z()) * static_cast<std::size_t>(count_.y()) +
            static_cast<std::size_t>(block.y())) *
               static_cast<std::size_t>(count_.x()) +
           static_cast<std::size_t>(block.x());
  }

  Vec3i edge_, count_;
  std::vector<std::uint8_t> sides_;
};

}  // namespace

std::vector<std::optional<float>> squaresAcross(const DenseField& field, const AcrossSearch& search) {
  const Sides sides(field, search);
  const std::vector<Candidate> candidates = candidatesOf(search, sides);
  const Blocks blocks(field, search, sides);
  std::vector<std::optional<float>> squares(field.values.size());
  for (int k = 0; k < field.size.z(); ++k) {
    for (int j = 0; j < field.size.y(); ++j) {
      for (int i = 0; i < field.size.x(); ++i) {
        if (blocks.isFarFromSurface({i, j, k})) continue;
        const std::size_t place = sides.place({i, j, k});
        const std::uint8_t across = sides.at(place) == kInside ? kOutside : kInside;
        const auto found = std::find_if(candidates.begin(), candidates.end(), [&](const Candidate& candidate) {
          return sides.at(place + static_cast<std::size_t>(candidate.step)) == across;
        });
        if (found != candidates.end()) squares[field.offset(i, j, k)] = found->square;
      }
    }
    if (search.after_slice) search.after_slice();
  }
  return squares;
}

}  // namespace palpate::reference
