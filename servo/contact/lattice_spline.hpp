// SPDX-License-Identifier: Apache-2.0
// servo/contact/lattice_spline.hpp: a smooth field in space, made from one number for each sample of a window.
//
// The field is the quadratic B-spline with these numbers as its coefficients. Its value and slope are continuous
// everywhere, and the slope is exactly that of the value. Numbers that are linear in space are reproduced exactly. The
// value lies between the smallest and the largest of the 27 numbers around the point. So the slope along an axis is at
// most twice half their range per voxel, however abruptly the numbers change, and the slope changes by at most
// kMostBend times half their range per voxel squared, in any direction. Beyond the window's outermost samples the field
// is constant.
// Frames: W world [m]; L the window's lattice [voxel]. Thread: the servo's. Cost: some 25 ns. If the nearest sample is
// another one than before, or the window is new, also 27 calls of number(). Errors: none.
#pragma once

#include <array>
#include <cmath>
#include <cstddef>

#include "servo/window/sample_window.hpp"

namespace palpate {

// Sample i of a usable window; i must be within the window.
[[nodiscard]] inline const Sample& sampleAt(const SampleWindow& window, const Vec3i& i) noexcept {
  return window.samples[i.x() + static_cast<std::ptrdiff_t>(window.size.x()) *
                                    (i.y() + static_cast<std::ptrdiff_t>(window.size.y()) * i.z())];
}

class LatticeSpline {
 public:
  // Of cubes; for other voxels with their smallest side. Found by a search over places, directions and numbers, which a
  // test repeats [-].
  static constexpr double kMostBend = 5.5625;
  // The same where the numbers have one value on this side of a plane and another beyond, times the difference of both.
  static constexpr double kBorderBend = 1.486;

  struct At {
    double value = 0;
    Vec3 gradient_W = Vec3::Zero();  // [1/m]
  };

  // Value and slope at a finite point of a usable window. `number(window, i)` gives the number of sample i; i is within
  // the window.
  template <class Number>
  [[nodiscard]] At at(const SampleWindow& window, const Vec3& p_W, const Number& number) noexcept {
    const Vec3 last = (window.size - Vec3i::Ones()).cast<double>();
    const Vec3 p_L = window.lattice.toIndex(p_W);
    const Vec3 inside_L = p_L.cwiseMax(Vec3::Zero()).cwiseMin(last);
    const Vec3i middle = (inside_L.array() + 0.5).floor().cast<int>().matrix().cwiseMin(window.size - Vec3i::Ones());
    if (middle != middle_ || window.version != version_ || window.samples != samples_) gather(window, middle, number);
    return evaluate(window.lattice, inside_L - middle.cast<double>(), inside_L.array() == p_L.array());
  }

  // Call it before another run: windows of that run may have the same versions and storage.
  void forget() noexcept { samples_ = nullptr; }

 private:
  template <class Number>
  void gather(const SampleWindow& window, const Vec3i& middle, const Number& number) noexcept {
    middle_ = middle;
    version_ = window.version;
    samples_ = window.samples;
    std::size_t n = 0;
    for (int k = -1; k <= 1; ++k) {
      for (int j = -1; j <= 1; ++j) {
        for (int i = -1; i <= 1; ++i) {
          const Vec3i at = (middle + Vec3i(i, j, k)).cwiseMax(Vec3i::Zero()).cwiseMin(window.size - Vec3i::Ones());
          numbers_[n++] = number(window, at);
        }
      }
    }
  }

  // `u`: offset from the middle sample, -0.5 to 0.5 along each axis [voxel]. `within`: false for axes along which the
  // point is outside the samples, where the field is constant.
  [[nodiscard]] At evaluate(const Lattice& lattice, const Vec3& u,
                            const Eigen::Array<bool, 3, 1>& within) const noexcept;

  std::array<double, 27> numbers_{};  // i fastest
  Vec3i middle_ = Vec3i::Zero();
  std::uint64_t version_ = 0;
  const Sample* samples_ = nullptr;  // null: no numbers are gathered
};

}  // namespace palpate
