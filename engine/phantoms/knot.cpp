// SPDX-License-Identifier: Apache-2.0
// The tube around a (2,3) torus knot. The distance is exact where the nearest point of the centre curve is unique. That
// holds near all of the surface: the tube does not fold, since its radius is a quarter of the curve's smallest radius
// of curvature.
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>

#include "engine/phantoms/kinds.hpp"
#include "engine/phantoms/solid.hpp"

namespace palpate {
namespace {

constexpr int kSamples = 512;
constexpr int kGroup = 16;  // samples that are looked at together
constexpr int kGroups = kSamples / kGroup;
constexpr double kStep = 2 * std::numbers::pi / kSamples;  // of the curve's parameter

// c(t) = ((A + B cos 3t) cos 2t, (A + B cos 3t) sin 2t, B sin 3t), lengths as parts of the scale: the half extent of a
// cube that the knot fills with some room. Its height is two fifths of its width, so a flat lattice (128x128x64) holds
// it at the scale of its width.
constexpr double kMajor = 0.55;
constexpr double kMinor = 0.25;
constexpr double kTube = 0.13;
constexpr double kMaxSpeed = 2 * (kMajor + kMinor) + 3 * kMinor;  // |c'(t)| stays below

double scaleThatFits_m(const PhantomSpec& spec) {
  constexpr double kReachAside = kMajor + kMinor + kTube;
  constexpr double kReachUp = kMinor + kTube;
  const Vec3 half_m = 0.5 * (spec.size - Vec3i::Ones()).cast<double>().cwiseProduct(spec.spacing_m);
  return std::min({half_m.x(), half_m.y(), half_m.z() * (kReachAside / kReachUp)});
}

struct CurvePoint {
  Vec3 position;
  Vec3 velocity;      // d/dt
  Vec3 acceleration;  // d2/dt2
};

CurvePoint curveAt(double t) {
  const double c2 = std::cos(2 * t);
  const double s2 = std::sin(2 * t);
  const double c3 = kMinor * std::cos(3 * t);
  const double s3 = kMinor * std::sin(3 * t);
  const double r = kMajor + c3;  // distance from the axis, and its derivatives -3 s3 and -9 c3
  return {{r * c2, r * s2, s3},
          {-3 * s3 * c2 - 2 * r * s2, -3 * s3 * s2 + 2 * r * c2, 3 * c3},
          {-9 * c3 * c2 + 12 * s3 * s2 - 4 * r * c2, -9 * c3 * s2 - 12 * s3 * c2 - 4 * r * s2, -9 * s3}};
}

// The root of (c(t) - p) . c'(t) near t: Newton's method held within one step of the sampling.
double refine(const Vec3& p, double t) {
  double low = t - kStep;
  double high = t + kStep;
  for (int step = 0; step < 60 && high - low > 1e-15; ++step) {
    const CurvePoint at = curveAt(t);
    const double value = (at.position - p).dot(at.velocity);
    const double slope = at.velocity.squaredNorm() + (at.position - p).dot(at.acceleration);
    (value > 0 ? high : low) = t;
    double next = slope > 0 ? t - value / slope : (low + high) / 2;
    if (next <= low || next >= high) next = (low + high) / 2;
    if (std::abs(next - t) < 1e-15) break;
    t = next;
  }
  return t;
}

class Knot : public Phantom {
 public:
  explicit Knot(const PhantomSpec& spec) : Phantom(spec, simpleProfile(spec)), scale_m_(scaleThatFits_m(spec)) {
    for (int n = 0; n < kSamples; ++n) samples_[n] = curveAt(n * kStep).position;
    for (int group = 0; group < kGroups; ++group) {
      for (int n = group * kGroup; n < (group + 1) * kGroup; ++n) {
        group_radii_[group] = std::max(group_radii_[group], (samples_[n] - middleOf(group)).norm());
      }
    }
  }

  [[nodiscard]] SurfaceOffset offset(const Vec3& p_W) const override {
    return sphereOffset(p_W, scale_m_ * nearestOnCurve(p_W / scale_m_), kTube * scale_m_);
  }

 private:
  [[nodiscard]] const Vec3& middleOf(int group) const { return samples_[group * kGroup + kGroup / 2]; }

  // Squares of the samples' distances; infinite for a group of which no sample is near enough to matter below.
  [[nodiscard]] std::array<double, kSamples> squaredDistances(const Vec3& p) const {
    std::array<double, kGroups> to_middle;
    for (int group = 0; group < kGroups; ++group) to_middle[group] = (middleOf(group) - p).norm();
    const double enough = *std::min_element(to_middle.begin(), to_middle.end()) + 1.01 * kMaxSpeed * kStep;
    std::array<double, kSamples> squared;
    squared.fill(std::numeric_limits<double>::infinity());
    for (int group = 0; group < kGroups; ++group) {
      if (to_middle[group] - group_radii_[group] > enough) continue;
      for (int n = group * kGroup; n < (group + 1) * kGroup; ++n) squared[n] = (samples_[n] - p).squaredNorm();
    }
    return squared;
  }

  // Every local minimum among the samples that could hold the global one is refined.
  [[nodiscard]] Vec3 nearestOnCurve(const Vec3& p) const {
    const std::array<double, kSamples> distance = squaredDistances(p);
    const double coarse = std::sqrt(*std::min_element(distance.begin(), distance.end()));
    const double limit = (coarse + kMaxSpeed * kStep) * (coarse + kMaxSpeed * kStep);
    Vec3 best = Vec3::Zero();
    double best_squared = std::numeric_limits<double>::infinity();
    for (int n = 0; n < kSamples; ++n) {
      if (distance[n] > limit || distance[n] > distance[(n + 1) % kSamples]) continue;
      if (distance[n] > distance[(n + kSamples - 1) % kSamples]) continue;
      const Vec3 candidate = curveAt(refine(p, n * kStep)).position;
      if ((candidate - p).squaredNorm() >= best_squared) continue;
      best_squared = (candidate - p).squaredNorm();
      best = candidate;
    }
    return best;
  }

  double scale_m_;
  std::array<Vec3, kSamples> samples_;
  std::array<double, kGroups> group_radii_{};  // from the middle sample of each
};

}  // namespace

std::unique_ptr<Phantom> makeKnot(const PhantomSpec& spec) {
  return std::make_unique<Knot>(spec);
}

}  // namespace palpate
