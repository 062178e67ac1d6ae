// SPDX-License-Identifier: Apache-2.0
// The gyroid f = sin x cos y + sin y cos z + sin z cos x = 0, with two periods along the lattice's shortest edge. It is
// solid where f is positive, and runs through the lattice's faces.
//
// The nearest surface point comes from Newton's method on x - p + m grad f(x) = 0, f(x) = 0. It starts at the nearest
// of a dense set of surface samples. So the distance is exact to rounding, except close to the medial axis (within the
// spacing of the samples, 0.01 periods). There it may be that of the second nearest sheet, which is farther by less
// than that spacing. Source of the surface: Schoen, NASA TN D-5541 (1970).
#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <vector>

#include "engine/phantoms/kinds.hpp"
#include "engine/phantoms/solid.hpp"

namespace palpate {
namespace {

constexpr double kPeriod = 2 * std::numbers::pi;  // of the functions below, which have no unit

double gyroid(const Vec3& x) {
  return std::sin(x.x()) * std::cos(x.y()) + std::sin(x.y()) * std::cos(x.z()) + std::sin(x.z()) * std::cos(x.x());
}

Vec3 gyroidGradient(const Vec3& x) {
  const Vec3 s = x.array().sin();
  const Vec3 c = x.array().cos();
  return {c.x() * c.y() - s.z() * s.x(), c.y() * c.z() - s.x() * s.y(), c.z() * c.x() - s.y() * s.z()};
}

Mat3 gyroidHessian(const Vec3& x) {
  const Vec3 s = x.array().sin();
  const Vec3 c = x.array().cos();
  const double xy = -c.x() * s.y();
  const double yz = -c.y() * s.z();
  const double zx = -c.z() * s.x();
  Mat3 hessian;
  hessian << -s.x() * c.y() - s.z() * c.x(), xy, zx,  //
      xy, -s.y() * c.z() - s.x() * c.y(), yz,         //
      zx, yz, -s.z() * c.x() - s.y() * c.z();
  return hessian;
}

// Pulls a point onto the surface along the gradient.
Vec3 project(Vec3 x) {
  for (int step = 0; step < 20; ++step) {
    const Vec3 gradient = gyroidGradient(x);
    x -= gyroid(x) / std::max(gradient.squaredNorm(), 1e-6) * gradient;
  }
  return x;
}

// The surface point nearest to p. The iteration starts at a surface point `x` near p, and returns `x` if it strays.
Vec3 footPoint(const Vec3& p, const Vec3& start) {
  Vec3 x = start;
  double m = (p - x).dot(gyroidGradient(x)) / gyroidGradient(x).squaredNorm();
  for (int step = 0; step < 12; ++step) {
    const Vec3 gradient = gyroidGradient(x);
    Eigen::Matrix4d jacobian = Eigen::Matrix4d::Zero();
    jacobian.topLeftCorner<3, 3>() = Mat3::Identity() + m * gyroidHessian(x);
    jacobian.topRightCorner<3, 1>() = gradient;
    jacobian.bottomLeftCorner<1, 3>() = gradient.transpose();
    Eigen::Vector4d residual;
    residual << x - p + m * gradient, gyroid(x);
    const Eigen::Vector4d change = jacobian.partialPivLu().solve(residual);
    x -= change.head<3>();
    m -= change[3];
    if (change.head<3>().squaredNorm() < 1e-30) break;
  }
  const bool sane = x.allFinite() && std::abs(gyroid(x)) < 1e-10 && (x - p).norm() <= (start - p).norm() + 1e-9;
  return sane ? x : start;
}

// Surface samples of one period, in buckets that each list every sample that can be nearest to a point of the bucket.
class SurfaceSamples {
 public:
  SurfaceSamples() : lists_(std::size_t{kBuckets} * kBuckets * kBuckets) {
    const std::vector<Vec3> samples = sampleOnePeriod();
    for (int n = 0; n < kBuckets * kBuckets * kBuckets; ++n) fill(n, samples);
  }

  // The samples to try for a point of [0, kPeriod)^3.
  [[nodiscard]] const std::vector<Vec3>& near(const Vec3& p) const {
    const Vec3i at = (p / kBucket).array().floor().cast<int>().matrix().cwiseMin(kBuckets - 1).cwiseMax(0);
    return lists_[(static_cast<std::size_t>(at.z()) * kBuckets + at.y()) * kBuckets + at.x()];
  }

 private:
  static constexpr int kBuckets = 16;
  static constexpr double kBucket = kPeriod / kBuckets;
  static constexpr int kSeeds = 24;  // along an axis

  static std::vector<Vec3> sampleOnePeriod() {
    std::vector<Vec3> samples;
    const double step = kPeriod / kSeeds;
    for (int n = 0; n < kSeeds * kSeeds * kSeeds; ++n) {
      const Vec3i at(n % kSeeds, n / kSeeds % kSeeds, n / kSeeds / kSeeds);
      const Vec3 seed = step * at.cast<double>();
      const Vec3 x = project(seed);
      if ((x - seed).norm() < step && std::abs(gyroid(x)) < 1e-12) samples.push_back(x);
    }
    return samples;
  }

  void fill(int n, const std::vector<Vec3>& samples) {
    const Vec3i at(n % kBuckets, n / kBuckets % kBuckets, n / kBuckets / kBuckets);
    const Vec3 middle = kBucket * (at.cast<double>().array() + 0.5);
    const auto shifted = [&](const Vec3& x) -> Vec3 {  // to the period's image nearest to the bucket
      return x - kPeriod * ((x - middle) / kPeriod).array().round().matrix();
    };
    double nearest = kPeriod;
    for (const Vec3& x : samples) nearest = std::min(nearest, (shifted(x) - middle).norm());
    const double reach = nearest + std::sqrt(3.0) * kBucket;  // the triangle inequality, from any corner
    for (const Vec3& x : samples) {
      if ((shifted(x) - middle).norm() <= reach) lists_[static_cast<std::size_t>(n)].push_back(shifted(x));
    }
  }

  std::vector<std::vector<Vec3>> lists_;
};

class Gyroid : public Phantom {
 public:
  explicit Gyroid(const PhantomSpec& spec)
      : Phantom(spec, simpleProfile(spec)), scale_m_(halfExtent_m(spec) / kPeriod) {}

  [[nodiscard]] SurfaceOffset offset(const Vec3& p_W) const override {
    const Vec3 raw = p_W / scale_m_;
    const Vec3 p = raw - kPeriod * (raw / kPeriod).array().floor().matrix();
    const Vec3 x = nearest(p);
    return {std::copysign((p - x).norm() * scale_m_, -gyroid(p)), -gyroidGradient(x).normalized()};
  }

 private:
  // Refines from the nearest samples of clearly different places.
  [[nodiscard]] Vec3 nearest(const Vec3& p) const {
    constexpr double kApart = 0.5;
    const std::vector<Vec3>& candidates = samples_.near(p);
    const auto closer = [&](const Vec3& a, const Vec3& b) { return (a - p).squaredNorm() < (b - p).squaredNorm(); };
    const Vec3 first = *std::min_element(candidates.begin(), candidates.end(), closer);
    Vec3 best = footPoint(p, first);
    const double limit = (first - p).norm() + kApart / 2;
    const Vec3* second = nullptr;
    for (const Vec3& x : candidates) {
      if ((x - first).norm() < kApart || (x - p).norm() > limit) continue;
      if (second == nullptr || closer(x, *second)) second = &x;
    }
    if (second != nullptr) best = std::min(best, footPoint(p, *second), closer);
    return best;
  }

  double scale_m_;  // of one unit of the functions above [m]
  SurfaceSamples samples_;
};

}  // namespace

std::unique_ptr<Phantom> makeGyroid(const PhantomSpec& spec) {
  return std::make_unique<Gyroid>(spec);
}

}  // namespace palpate
