// SPDX-License-Identifier: Apache-2.0
// tests/servo/support/analytic_volume.hpp: a volume that is a formula, and the windows that an engine would cut from
// it.
//
// Density is the formula at the samples; gradients are central differences of samples, one-sided at the volume's ends.
#pragma once

#include <algorithm>
#include <functional>
#include <vector>

#include "servo/window/sample_window.hpp"

namespace palpate {

// A window and its samples, as one object that stays where it is.
struct HeldWindow {
  SampleWindow window;
  std::vector<Sample> samples;
};

struct AnalyticVolume {
  Lattice lattice;
  Vec3i size = Vec3i::Constant(64);
  std::function<double(const Vec3& p_W)> density;

  [[nodiscard]] double sample(const Vec3i& at) const { return density(lattice.toWorld(at.cast<double>())); }

  [[nodiscard]] Sample sampleWithGradient(const Vec3i& at) const {
    double gradient[3] = {};
    for (int axis = 0; axis < 3; ++axis) {
      Vec3i low = at;
      Vec3i high = at;
      low[axis] = std::max(at[axis] - 1, 0);
      high[axis] = std::min(at[axis] + 1, size[axis] - 1);
      gradient[axis] = (sample(high) - sample(low)) / ((high[axis] - low[axis]) * lattice.spacing_m[axis]);
    }
    return {static_cast<float>(gradient[0]), static_cast<float>(gradient[1]), static_cast<float>(gradient[2]),
            static_cast<float>(sample(at))};
  }

  // Fills the samples [first, first + count) and what the window says of itself, but for version and stamp.
  void fill(SampleWindow& window, Sample* samples, const Vec3i& first, const Vec3i& count) const {
    window.lattice = lattice.shifted(first);
    window.size = count;
    for (std::size_t axis = 0; axis < 3; ++axis) {
      const int a = static_cast<int>(axis);
      window.low_is_border[axis] = first[a] == 0;
      window.high_is_border[axis] = first[a] + count[a] == size[a];
    }
    for (int k = 0; k < count.z(); ++k) {
      for (int j = 0; j < count.y(); ++j) {
        for (int i = 0; i < count.x(); ++i) *samples++ = sampleWithGradient(first + Vec3i(i, j, k));
      }
    }
  }

  // The first sample of a window of `count` around a point, kept in the volume.
  [[nodiscard]] Vec3i firstAround(const Vec3& p_W, const Vec3i& count) const {
    const Vec3i middle = lattice.toIndex(p_W).array().round().cast<int>().matrix() - count / 2;
    return middle.cwiseMax(Vec3i::Zero()).cwiseMin(size - count);
  }

  void hold(HeldWindow& held, const Vec3i& first, const Vec3i& count, std::uint64_t version = 1) const {
    held.samples.resize(static_cast<std::size_t>(count.prod()));
    fill(held.window, held.samples.data(), first, count);
    held.window.samples = held.samples.data();
    held.window.version = version;
  }
};

// R - |x - c|: positive inside, gradient of length 1 inwards [m].
inline std::function<double(const Vec3&)> ball(const Vec3& centre_W, double radius_m) {
  return [=](const Vec3& p_W) { return radius_m - (p_W - centre_W).norm(); };
}

// A spherical wall: inside where the distance from the sphere is below half the thickness.
inline std::function<double(const Vec3&)> shell(const Vec3& centre_W, double radius_m, double thickness_m) {
  return [=](const Vec3& p_W) { return 0.5 * thickness_m - std::abs((p_W - centre_W).norm() - radius_m); };
}

// Millimetre voxels with sample (0, 0, 0) at the world's origin.
inline AnalyticVolume millimetreVolume(std::function<double(const Vec3&)> density, int side = 64) {
  AnalyticVolume volume;
  volume.size = Vec3i::Constant(side);
  volume.density = std::move(density);
  return volume;
}

}  // namespace palpate
