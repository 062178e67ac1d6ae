// SPDX-License-Identifier: Apache-2.0
// tests/servo/support/analytic_volume.hpp: a volume that is a formula, and the windows that an engine would cut from
// it.
//
// Density is the formula at the samples; gradients are central differences of samples, one-sided at the volume's ends.
#pragma once

#include <algorithm>
#include <functional>
#include <memory>
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
  std::shared_ptr<const std::vector<double>> samples = nullptr;  // if set, they are used in place of the formula

  [[nodiscard]] double sample(const Vec3i& at) const {
    if (samples) return (*samples)[at.x() + size.x() * (at.y() + size.y() * static_cast<std::size_t>(at.z()))];
    return density(lattice.toWorld(at.cast<double>()));
  }

  // Fills the samples [first, first + count) and the fields of the window, except version and stamp.
  void fill(SampleWindow& window, Sample* out, const Vec3i& first, const Vec3i& count) const {
    window.lattice = lattice.shifted(first);
    window.size = count;
    for (std::size_t axis = 0; axis < 3; ++axis) {
      const int a = static_cast<int>(axis);
      window.low_is_border[axis] = first[a] == 0;
      window.high_is_border[axis] = first[a] + count[a] == size[a];
    }
    // Computes each density once: those of the window, and of one layer of samples around it, where the volume has
    // them.
    const Vec3i low = (first - Vec3i::Ones()).cwiseMax(Vec3i::Zero());
    const Vec3i sides = (first + count + Vec3i::Ones()).cwiseMin(size) - low;
    std::vector<double> densities;
    densities.reserve(static_cast<std::size_t>(sides.prod()));
    for (int k = 0; k < sides.z(); ++k) {
      for (int j = 0; j < sides.y(); ++j) {
        for (int i = 0; i < sides.x(); ++i) densities.push_back(sample(low + Vec3i(i, j, k)));
      }
    }
    const std::ptrdiff_t strides[] = {1, sides.x(), static_cast<std::ptrdiff_t>(sides.x()) * sides.y()};
    for (int k = 0; k < count.z(); ++k) {
      for (int j = 0; j < count.y(); ++j) {
        for (int i = 0; i < count.x(); ++i) {
          const Vec3i at = first + Vec3i(i, j, k);
          const Vec3i from_low = at - low;
          const double* here = densities.data() + from_low.x() + strides[1] * from_low.y() + strides[2] * from_low.z();
          float gradient[3] = {};
          for (int axis = 0; axis < 3; ++axis) {
            const int below = at[axis] > 0 ? 1 : 0;
            const int above = at[axis] + 1 < size[axis] ? 1 : 0;
            const double rise = here[above * strides[axis]] - here[-below * strides[axis]];
            gradient[axis] = static_cast<float>(rise / ((below + above) * lattice.spacing_m[axis]));
          }
          *out++ = {gradient[0], gradient[1], gradient[2], static_cast<float>(*here)};
        }
      }
    }
  }

  // The first sample of a window of `count` samples around a point. The window stays within the volume.
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

// The same lattice with other samples, x fastest; between them the nearest one is taken.
inline AnalyticVolume withSamples(const AnalyticVolume& like, std::vector<double> samples) {
  AnalyticVolume volume{like.lattice, like.size, nullptr,
                        std::make_shared<const std::vector<double>>(std::move(samples))};
  volume.density = [volume](const Vec3& p_W) {
    return volume.sample(volume.lattice.toIndex(p_W).array().round().cast<int>());
  };
  return volume;
}

// The same volume, with each sample computed once.
inline AnalyticVolume stored(const AnalyticVolume& formula) {
  std::vector<double> values;
  values.reserve(static_cast<std::size_t>(formula.size.prod()));
  for (int k = 0; k < formula.size.z(); ++k) {
    for (int j = 0; j < formula.size.y(); ++j) {
      for (int i = 0; i < formula.size.x(); ++i) values.push_back(formula.sample(Vec3i(i, j, k)));
    }
  }
  return withSamples(formula, std::move(values));
}

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
