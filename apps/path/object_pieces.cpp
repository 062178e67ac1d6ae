// SPDX-License-Identifier: Apache-2.0
#include "apps/path/object_pieces.hpp"

#include <algorithm>
#include <array>
#include <limits>
#include <numeric>

namespace palpate {
namespace {

// A surface may go through a sample that is exactly at the isovalue: the cells on both sides of it are looked at.
// [voxel]
constexpr double kOnSample = 1e-3;
constexpr std::uint32_t kNone = std::numeric_limits<std::uint32_t>::max();

}  // namespace

ObjectPieces::ObjectPieces(const SurfaceField& field) : size_(field.size()), lattice_(field.lattice()) {
  findRuns(field);
  joinRows();
  numberPieces();
}

// A row of blocks at a time: its 64 rows of samples grow side by side, so a constant block costs no look at its
// samples.
void ObjectPieces::findRuns(const SurfaceField& field) {
  const auto isovalue = static_cast<float>(field.isovalue());
  const Vec3i blocks = (size_ + Vec3i::Constant(kFieldBlock - 1)) / kFieldBlock;
  const std::size_t rows = rowOf(0, size_.z());
  first_.assign(rows, 0);
  count_.assign(rows, 0);
  std::array<float, kFieldBlockSamples> values{};
  std::array<std::vector<Run>, std::size_t{kFieldBlock} * kFieldBlock> open;
  const auto put = [](std::vector<Run>& row, int begin, int end) {
    if (!row.empty() && row.back().end == begin) {
      row.back().end = end;
    } else {
      row.push_back({begin, end, 0});
    }
  };
  for (int bz = 0; bz < blocks.z(); ++bz) {
    for (int by = 0; by < blocks.y(); ++by) {
      for (auto& row : open) row.clear();
      const int deep = std::min(kFieldBlock, size_.z() - bz * kFieldBlock);
      const int high = std::min(kFieldBlock, size_.y() - by * kFieldBlock);
      for (int bx = 0; bx < blocks.x(); ++bx) {
        const int begin = bx * kFieldBlock, wide = std::min(kFieldBlock, size_.x() - begin);
        const bool is_constant = field.readBlock({bx, by, bz}, values.data());
        if (is_constant && !(values[0] > isovalue)) continue;
        for (int row = 0; row < deep * high; ++row) {
          std::vector<Run>& runs = open[static_cast<std::size_t>(row)];
          if (is_constant) {
            put(runs, begin, begin + wide);
            continue;
          }
          const float* samples = values.data() + (std::ptrdiff_t{row / high} * kFieldBlock + row % high) * kFieldBlock;
          for (int i = 0; i < wide; ++i) {
            if (samples[i] > isovalue) put(runs, begin + i, begin + i + 1);
          }
        }
      }
      for (int row = 0; row < deep * high; ++row) {
        const std::vector<Run>& runs = open[static_cast<std::size_t>(row)];
        const std::size_t at = rowOf(by * kFieldBlock + row % high, bz * kFieldBlock + row / high);
        first_[at] = static_cast<std::uint32_t>(runs_.size());
        count_[at] = static_cast<std::uint32_t>(runs.size());
        runs_.insert(runs_.end(), runs.begin(), runs.end());
      }
    }
  }
  for (std::size_t i = 0; i < runs_.size(); ++i) runs_[i].piece = static_cast<std::uint32_t>(i);
}

std::uint32_t ObjectPieces::rootOf(std::uint32_t run) {
  while (runs_[run].piece != run) {
    runs_[run].piece = runs_[runs_[run].piece].piece;  // path halving
    run = runs_[run].piece;
  }
  return run;
}

void ObjectPieces::joinRows(std::size_t row, std::size_t other) {
  std::uint32_t a = first_[row], b = first_[other];
  const std::uint32_t a_end = a + count_[row], b_end = b + count_[other];
  while (a < a_end && b < b_end) {
    if (runs_[a].begin < runs_[b].end && runs_[b].begin < runs_[a].end) {
      const std::uint32_t x = rootOf(a), y = rootOf(b);
      runs_[std::max(x, y)].piece = std::min(x, y);
    }
    ++(runs_[a].end < runs_[b].end ? a : b);
  }
}

void ObjectPieces::joinRows() {
  for (int k = 0; k < size_.z(); ++k) {
    for (int j = 0; j < size_.y(); ++j) {
      if (j > 0) joinRows(rowOf(j, k), rowOf(j - 1, k));
      if (k > 0) joinRows(rowOf(j, k), rowOf(j, k - 1));
    }
  }
}

void ObjectPieces::numberPieces() {
  std::vector<std::uint32_t> number(runs_.size(), kNone);  // of a root
  for (int k = 0; k < size_.z(); ++k) {
    for (int j = 0; j < size_.y(); ++j) {
      const std::size_t row = rowOf(j, k);
      for (std::uint32_t i = first_[row]; i < first_[row] + count_[row]; ++i) {
        const Vec3i begin(runs_[i].begin, j, k), last(runs_[i].end - 1, j, k);
        std::uint32_t& its = number[rootOf(i)];
        if (its == kNone) {
          its = static_cast<std::uint32_t>(pieces_.size());
          pieces_.push_back({0, begin, last});
        }
        ObjectPiece& piece = pieces_[its];
        piece.voxels += runs_[i].end - runs_[i].begin;
        piece.first = piece.first.cwiseMin(begin);
        piece.last = piece.last.cwiseMax(last);
      }
    }
  }
  std::vector<std::uint32_t> order(pieces_.size()), place(pieces_.size());
  std::iota(order.begin(), order.end(), 0U);
  std::stable_sort(order.begin(), order.end(),
                   [&](std::uint32_t a, std::uint32_t b) { return pieces_[a].voxels > pieces_[b].voxels; });
  std::vector<ObjectPiece> sorted;
  for (std::uint32_t i = 0; i < order.size(); ++i) {
    sorted.push_back(pieces_[order[i]]);
    place[order[i]] = i;
  }
  pieces_ = std::move(sorted);
  // A root comes before the runs that lead to it, so going backwards every chain is still whole when it is needed.
  for (std::size_t i = runs_.size(); i-- > 0;) {
    const std::uint32_t root = rootOf(static_cast<std::uint32_t>(i));
    if (root != i) runs_[i].piece = place[number[root]];
  }
  for (std::size_t i = 0; i < runs_.size(); ++i) {
    if (number[i] != kNone) runs_[i].piece = place[number[i]];
  }
}

std::optional<std::size_t> ObjectPieces::pieceOf(const Vec3i& voxel) const {
  if ((voxel.array() < 0).any() || (voxel.array() >= size_.array()).any()) return std::nullopt;
  const std::size_t row = rowOf(voxel.y(), voxel.z());
  const auto begin = runs_.begin() + static_cast<std::ptrdiff_t>(first_[row]);
  const auto end = begin + static_cast<std::ptrdiff_t>(count_[row]);
  const auto run = std::upper_bound(begin, end, voxel.x(), [](int i, const Run& r) { return i < r.end; });
  if (run == end || run->begin > voxel.x()) return std::nullopt;
  return run->piece;
}

std::optional<std::size_t> ObjectPieces::pieceAt(const Vec3& surface_W) const {
  const Vec3 p_L = lattice_.toIndex(surface_W);
  const Vec3i begin = (p_L.array() - kOnSample).floor().cast<int>();
  const Vec3i end = (p_L.array() + kOnSample).floor().cast<int>() + 2;
  std::optional<std::size_t> nearest;
  double least = std::numeric_limits<double>::infinity();
  for (int k = begin.z(); k < end.z(); ++k) {
    for (int j = begin.y(); j < end.y(); ++j) {
      for (int i = begin.x(); i < end.x(); ++i) {
        const auto piece = pieceOf({i, j, k});
        const double distance = (Vec3(i, j, k) - p_L).squaredNorm();
        if (!piece || distance >= least) continue;
        least = distance;
        nearest = piece;
      }
    }
  }
  return nearest;
}

std::vector<ObjectPieces::Entry> ObjectPieces::entries(std::size_t piece, std::size_t count) const {
  std::vector<Entry> all;
  for (int k = 0; k < size_.z(); ++k) {
    for (int j = 0; j < size_.y(); ++j) {
      const std::size_t row = rowOf(j, k);
      for (std::uint32_t i = first_[row]; i < first_[row] + count_[row]; ++i) {
        if (runs_[i].piece != piece) continue;
        if (runs_[i].begin > 0) all.push_back({{runs_[i].begin - 1, j, k}, 1});
        if (runs_[i].end < size_.x()) all.push_back({{runs_[i].end, j, k}, -1});
      }
    }
  }
  if (all.size() <= count) return all;
  std::vector<Entry> some;
  for (std::size_t n = 0; n < count; ++n) some.push_back(all[n * all.size() / count]);
  return some;
}

}  // namespace palpate
