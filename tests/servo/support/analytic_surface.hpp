// SPDX-License-Identifier: Apache-2.0
// tests/servo/support/analytic_surface.hpp: surfaces with exact distance and normal, and what sampling makes of them.
//
// Distance is negative inside [m]. The density of the volumes is minus the distance, so gradients have length 1.
#pragma once

#include <array>
#include <cmath>
#include <functional>
#include <limits>
#include <memory>
#include <numbers>
#include <random>

#include "support/analytic_volume.hpp"

namespace palpate {

struct AnalyticSurface {
  std::function<double(const Vec3& p_W)> distance_m;
  std::function<Vec3(const Vec3& p_W)> normal;  // at the surface point nearest to p
};

inline AnalyticSurface planeSurface(const Vec3& p_W, const Vec3& normal) {
  Vec3 n = normal.normalized();
  return {[=](const Vec3& x_W) { return n.dot(x_W - p_W); }, [=](const Vec3&) { return n; }};
}

inline AnalyticSurface ballSurface(const Vec3& centre_W, double radius_m) {
  return {[=](const Vec3& x_W) { return (x_W - centre_W).norm() - radius_m; },
          [=](const Vec3& x_W) { return (x_W - centre_W).normalized(); }};
}

// The same surface with object and background exchanged: a ball becomes a hollow.
inline AnalyticSurface hollow(const AnalyticSurface& solid) {
  return {[=](const Vec3& x_W) { return -solid.distance_m(x_W); },
          [=](const Vec3& x_W) { return Vec3(-solid.normal(x_W)); }};
}

// A box with edges along the axes of the world. The normal is that of the nearest face, for points near a face.
inline AnalyticSurface boxSurface(const Vec3& centre_W, const Vec3& half_m) {
  const auto past = [=](const Vec3& x_W) { return Vec3((x_W - centre_W).cwiseAbs() - half_m); };
  return {[=](const Vec3& x_W) {
            const Vec3 q = past(x_W);
            return q.cwiseMax(0.0).norm() + std::min(q.maxCoeff(), 0.0);
          },
          [=](const Vec3& x_W) {
            Eigen::Index axis = 0;
            past(x_W).maxCoeff(&axis);
            return Vec3(Vec3::Unit(axis) * ((x_W - centre_W)[axis] < 0 ? -1.0 : 1.0));
          }};
}

// A torus around an axis along z.
inline AnalyticSurface torusSurface(const Vec3& centre_W, double ring_m, double tube_m) {
  const auto offset = [=](const Vec3& x_W) {
    const Vec3 q = x_W - centre_W;
    const Vec3 ring = Vec3(q.x(), q.y(), 0).normalized() * ring_m;
    return Vec3(q - ring);
  };
  return {[=](const Vec3& x_W) { return offset(x_W).norm() - tube_m; },
          [=](const Vec3& x_W) { return Vec3(offset(x_W).normalized()); }};
}

// The tube around the (2,3) torus knot ((A + B cos 3t) cos 2t, (A + B cos 3t) sin 2t, B sin 3t), A = 0.55, B = 0.25.
class TorusKnot {
 public:
  TorusKnot(const Vec3& centre_W, double scale_m, double tube_m)
      : centre_W_(centre_W), scale_m_(scale_m), tube_m_(tube_m) {
    for (int i = 0; i < kSamples; ++i) samples_[static_cast<std::size_t>(i)] = at(i * kStep);
    for (std::size_t group = 0; group < kGroups; ++group) {
      for (std::size_t i = group * kGroup; i < (group + 1) * kGroup; ++i) {
        group_radii_[group] = std::max(group_radii_[group], (samples_[i] - middleOf(group)).norm());
      }
    }
  }

  static Vec3 at(double t) {
    const double r = 0.55 + 0.25 * std::cos(3 * t);
    return {r * std::cos(2 * t), r * std::sin(2 * t), 0.25 * std::sin(3 * t)};
  }
  // The point at parameter t of the knot, `angle` around the tube, `depth_m` below its surface.
  [[nodiscard]] Vec3 below(double t, double angle, double depth_m) const {
    const Vec3 along = velocity(t).normalized();
    const Vec3 u = along.cross(Vec3(0.3, 0.2, 1)).normalized();
    return centre_W_ + scale_m_ * at(t) +
           (tube_m_ - depth_m) * (u * std::cos(angle) + along.cross(u) * std::sin(angle));
  }
  [[nodiscard]] AnalyticSurface surface() const {
    const auto self = std::make_shared<TorusKnot>(*this);
    return {[=](const Vec3& x_W) { return (x_W - self->nearestOnCurve(x_W)).norm() - self->tube_m_; },
            [=](const Vec3& x_W) { return Vec3((x_W - self->nearestOnCurve(x_W)).normalized()); }};
  }

 private:
  static constexpr int kSamples = 512;
  static constexpr std::size_t kGroup = 16, kGroups = kSamples / kGroup;
  static constexpr double kStep = 2 * std::numbers::pi / kSamples;

  static Vec3 velocity(double t) {
    const double r = 0.55 + 0.25 * std::cos(3 * t);
    const double dr = -0.75 * std::sin(3 * t);
    return {dr * std::cos(2 * t) - 2 * r * std::sin(2 * t), dr * std::sin(2 * t) + 2 * r * std::cos(2 * t),
            0.75 * std::cos(3 * t)};
  }
  [[nodiscard]] const Vec3& middleOf(std::size_t group) const { return samples_[group * kGroup + kGroup / 2]; }

  // The best sample, then Gauss-Newton on (c(t) - p) . c'(t) = 0: near the tube's surface c'' matters little.
  [[nodiscard]] Vec3 nearestOnCurve(const Vec3& x_W) const {
    const Vec3 p = (x_W - centre_W_) / scale_m_;
    double t = static_cast<double>(nearestSample(p)) * kStep;
    for (int i = 0; i < 12; ++i) {
      const Vec3 v = velocity(t);
      const double step = std::clamp((at(t) - p).dot(v) / v.squaredNorm(), -kStep, kStep);
      if (step == 0) break;
      t -= step;
    }
    return centre_W_ + scale_m_ * at(t);
  }
  // Groups whose nearest place is farther than a known sample are skipped. The time matters: knots are half of what the
  // tests sample.
  [[nodiscard]] std::size_t nearestSample(const Vec3& p) const {
    std::array<double, kGroups> distances;
    double limit = std::numeric_limits<double>::infinity();
    for (std::size_t group = 0; group < kGroups; ++group) {
      distances[group] = (middleOf(group) - p).norm();
      limit = std::min(limit, distances[group]);
    }
    std::size_t best = 0;
    double best_squared = std::numeric_limits<double>::infinity();
    for (std::size_t group = 0; group < kGroups; ++group) {
      if (distances[group] - group_radii_[group] > limit) continue;
      for (std::size_t i = group * kGroup; i < (group + 1) * kGroup; ++i) {
        const double squared = (samples_[i] - p).squaredNorm();
        if (squared >= best_squared) continue;
        best_squared = squared;
        best = i;
      }
    }
    return best;
  }

  Vec3 centre_W_;
  double scale_m_;
  double tube_m_;
  std::array<Vec3, kSamples> samples_;
  std::array<double, kGroups> group_radii_{};
};

// Millimetre voxels; the formula is evaluated once for each sample. Beyond 4 voxels from the surface the density is
// flat, as in a scan.
inline AnalyticVolume sampledVolume(const AnalyticSurface& surface, int side = 64) {
  return stored(
      millimetreVolume([=](const Vec3& p_W) { return std::clamp(-surface.distance_m(p_W), -4e-3, 4e-3); }, side));
}

// The same with noise: each sample has one value of a normal distribution added.
inline AnalyticVolume noisy(const AnalyticVolume& volume, double sigma, unsigned seed) {
  std::vector<double> values;
  std::mt19937 random(seed);
  std::normal_distribution<double> normal(0, sigma);
  for (int k = 0; k < volume.size.z(); ++k) {
    for (int j = 0; j < volume.size.y(); ++j) {
      for (int i = 0; i < volume.size.x(); ++i) values.push_back(volume.sample({i, j, k}) + normal(random));
    }
  }
  return withSamples(volume, std::move(values));
}

// The errors of a distance field sampled at millimetres, with curvatures of at most 1 / R, R in voxels. Second
// derivatives are then at most 1 / R, third ones 1.155 / R^2 (the most that x / |x| bends along one axis).
struct SamplingBound {
  double voxels;   // trilinear interpolation: h^2 / 8 in each of two curved directions
  double radians;  // central difference h^2 / 6 f''' and its interpolation, h^2 / 8 along three axes; three components
};
inline SamplingBound samplingBound(double radius_voxel) {
  const double third = 1.155 / (radius_voxel * radius_voxel);
  return {0.25 / radius_voxel, std::numbers::sqrt3 * (1.0 / 6 + 3.0 / 8) * third};
}

}  // namespace palpate
