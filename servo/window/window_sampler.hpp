// SPDX-License-Identifier: Apache-2.0
// servo/window/window_sampler.hpp: density and gradient of a window at points of the world.
//
// Both are trilinear in the window's lattice, from the same eight samples. The gradient is in the world [density/m]. A
// point outside the window may be past several of its faces. If all of these are borders of the volume, the result is
// kBeyondVolume with density -infinity, else kBeyondWindow. An unusable window and a non-finite point give
// kBeyondWindow.
// Frames: W world [m]; L the window's lattice [voxel]. Positions are computed in double, weights and samples in float.
// Thread: any. The sampler reads the samples of its window, so it must not outlive them. Cost: some 20 ns to make a
// sampler; at() takes eight 16-byte loads and seven lerps of four floats, some 20 ns in a dependent chain. Errors:
// none.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>

#include "servo/window/sample_window.hpp"

namespace palpate {

class WindowSampler {
 public:
  WindowSampler() = default;  // without a window: every place is beyond it
  explicit WindowSampler(const SampleWindow& window) noexcept;

  // toIndex() takes world [m] to lattice [voxel], toWorld() the reverse. faceNormal() is the outward unit normal of the
  // window's face at the high or low end of an axis.
  [[nodiscard]] Vec3 toIndex(const Vec3& p_W) const noexcept {
    const double x = p_W.x() - origin_W_.x();
    const double y = p_W.y() - origin_W_.y();
    const double z = p_W.z() - origin_W_.z();
    return {A_LW_(0, 0) * x + A_LW_(0, 1) * y + A_LW_(0, 2) * z, A_LW_(1, 0) * x + A_LW_(1, 1) * y + A_LW_(1, 2) * z,
            A_LW_(2, 0) * x + A_LW_(2, 1) * y + A_LW_(2, 2) * z};
  }
  [[nodiscard]] Vec3 toWorld(const Vec3& p_L) const noexcept { return window_->lattice.toWorld(p_L); }
  [[nodiscard]] Vec3 faceNormal(int axis, bool high) const noexcept {
    return window_->lattice.R_WL.col(axis) * (high ? 1.0 : -1.0);
  }
  [[nodiscard]] const Vec3& lastIndex() const noexcept { return last_L_; }               // size - 1 [voxel]
  [[nodiscard]] double smallestSpacing() const noexcept { return smallest_spacing_m_; }  // [m]

  // How many voxels a way passes: its length in the lattice [voxel]. The square saves the root where it is compared.
  [[nodiscard]] double squaredVoxels(const Vec3& way_W) const noexcept {
    if (cubic_) return way_W.squaredNorm() / (smallest_spacing_m_ * smallest_spacing_m_);
    return (A_LW_ * way_W).squaredNorm();
  }
  // The length of a voxel along a way: 0.4 mm within a slice, 5 mm from slice to slice [m]. Of no way: the smallest
  // side.
  [[nodiscard]] double voxelAlong(const Vec3& way_W) const noexcept {
    if (cubic_) return smallest_spacing_m_;
    const double squared = squaredVoxels(way_W);
    return squared > 0 ? std::sqrt(way_W.squaredNorm() / squared) : smallest_spacing_m_;
  }

  [[nodiscard]] Place place(const Vec3& p_W) const noexcept { return placeOf(toIndex(p_W)); }

  // The highest density at the corners of the one cell that holds both points; infinity if no cell does. Cost: eight
  // loads.
  [[nodiscard]] double highestAround(const Vec3& a_L, const Vec3& b_L) const noexcept {
    constexpr double kNone = std::numeric_limits<double>::infinity();
    if (!holds(a_L) || !holds(b_L)) return kNone;
    const Vec3i cell_L = cellOf(a_L);
    if (cellOf(b_L) != cell_L) return kNone;
    const Sample* low = samples_ + (cell_L.x() + row_ * cell_L.y() + slice_ * cell_L.z());
    const auto highest = [&](const Sample* s) {
      return std::max(std::max(s[0].density, s[1].density), std::max(s[row_].density, s[row_ + 1].density));
    };
    return std::max(highest(low), highest(low + slice_));
  }

  // Density and gradient at a point, both trilinear.
  [[nodiscard]] Fetch at(const Vec3& p_W) const noexcept {
    const Vec3 p_L = toIndex(p_W);
    if (!holds(p_L)) return beyond(p_L);
    return interpolate(p_L);
  }

 private:
  using Float4 = float __attribute__((vector_size(16)));  // gradient i, j, k and density of one sample

  // Rounding may put a point on a face this far outside, or farther where the lattice is far from the origin [voxel].
  static constexpr double kFaceTolerance = 1e-9;

  [[nodiscard]] bool holds(const Vec3& p_L) const noexcept {
    return p_L.x() >= low_ && p_L.y() >= low_ && p_L.z() >= low_ && p_L.x() <= high_L_.x() && p_L.y() <= high_L_.y() &&
           p_L.z() <= high_L_.z();
  }
  [[nodiscard]] Place placeOf(const Vec3& p_L) const noexcept {
    return holds(p_L) ? Place::kInside : beyond(p_L).place;
  }
  [[nodiscard]] Fetch beyond(const Vec3& p_L) const noexcept;

  static Float4 load(const Sample* sample) noexcept {
    Float4 value;
    std::memcpy(&value, sample, sizeof value);
    return value;
  }
  // This form of the lerp reproduces a constant field exactly, so flat background at the isovalue stays background.
  static Float4 lerp(Float4 a, Float4 b, Float4 t) noexcept { return a + t * (b - a); }
  static Float4 broadcast(double t) noexcept {
    const auto f = static_cast<float>(t);
    return Float4{f, f, f, f};
  }

  // Low corner of the cell along one axis. Truncation rounds down, since p >= 0 up to the tolerance. The last sample
  // belongs to the last cell.
  static int cell(double p, int last_cell) noexcept {
    const int i = static_cast<int>(p);
    return i < last_cell ? i : last_cell;
  }

  [[nodiscard]] Vec3i cellOf(const Vec3& p_L) const noexcept {
    return {cell(p_L.x(), last_cell_.x()), cell(p_L.y(), last_cell_.y()), cell(p_L.z(), last_cell_.z())};
  }

  [[nodiscard]] Fetch interpolate(const Vec3& p_L) const noexcept {
    const int i = cell(p_L.x(), last_cell_.x());
    const int j = cell(p_L.y(), last_cell_.y());
    const int k = cell(p_L.z(), last_cell_.z());
    const Sample* low = samples_ + (i + row_ * j + slice_ * k);
    const Sample* high = low + slice_;
    const Float4 u = broadcast(p_L.x() - i);
    const Float4 v = broadcast(p_L.y() - j);
    const Float4 w = broadcast(p_L.z() - k);
    const Float4 a = lerp(lerp(load(low), load(low + 1), u), lerp(load(low + row_), load(low + row_ + 1), u), v);
    const Float4 b = lerp(lerp(load(high), load(high + 1), u), lerp(load(high + row_), load(high + row_ + 1), u), v);
    const Float4 s = lerp(a, b, w);
    const double gi = s[0];
    const double gj = s[1];
    const double gk = s[2];
    return {s[3], Vec3(R_WL_.col(0) * gi + R_WL_.col(1) * gj + R_WL_.col(2) * gk), Place::kInside};
  }

  Vec3 origin_W_ = Vec3::Zero();
  Mat3 A_LW_ = Mat3::Zero();  // world offset [m] to lattice [voxel]
  Mat3 R_WL_ = Mat3::Identity();
  double low_ = -kFaceTolerance;
  Vec3 high_L_ = Vec3::Constant(-1);  // [voxel]; below low_: holds nothing
  Vec3 last_L_ = Vec3::Zero();
  Vec3i last_cell_ = Vec3i::Zero();
  std::ptrdiff_t row_ = 0, slice_ = 0;  // [sample]
  const Sample* samples_ = nullptr;
  double smallest_spacing_m_ = 1;
  bool cubic_ = true;  // all sides of a voxel are equal
  const SampleWindow* window_ = nullptr;
};

// Density and gradient of a window at one point: a WindowSampler is made and asked once. To fetch often, keep a
// sampler.
[[nodiscard]] Fetch fetch(const SampleWindow& window, const Vec3& p_W) noexcept;

}  // namespace palpate
