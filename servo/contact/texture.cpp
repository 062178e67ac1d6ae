// SPDX-License-Identifier: Apache-2.0
#include "servo/contact/texture.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace palpate {
namespace {

void raise(const ContactState& contact, const LatticeSpline::At& height, double amplitude_m,
           ContactPush& push) noexcept {
  const Vec3& normal_W = contact.felt.normal_W;
  const double depth_m = contact.felt.depth_m;
  if (!(depth_m > 0)) return;
  const double u = std::min(1.0, depth_m / (2 * amplitude_m));
  const double share = u * (2 - u);
  const double share_per_m = (1 - u) / amplitude_m;
  const double raised_m = depth_m + height.value * share;
  const Vec3 slope_W = contact.felt.shape.slopeAtHip(height.gradient_W, depth_m);
  push.vhip_W += normal_W * (raised_m * (1 + height.value * share_per_m) - depth_m) - raised_m * share * slope_W;
  push.energy_m2 += 0.5 * (raised_m * raised_m - depth_m * depth_m);
}

}  // namespace

// ---- procedural ----

ProceduralTexture::ProceduralTexture(double amplitude_m, double wavelength_m) noexcept
    : amplitude_m_(std::min(amplitude_m, kSteepest * wavelength_m * std::sqrt(3.0) / (2 * std::numbers::pi))) {
  // Turned so that no wave is within 28 degrees of an axis, and no two waves look alike on a plane across an axis.
  const Mat3 turned = (Eigen::AngleAxisd(2.5, Vec3::UnitZ()) * Eigen::AngleAxisd(0.5, Vec3::UnitX()) *
                       Eigen::AngleAxisd(2.0, Vec3::UnitZ()))
                          .toRotationMatrix();
  const double per_m = 2 * std::numbers::pi / wavelength_m / std::sqrt(3.0);
  k_W_ = {turned * Vec3(1, 1, 1) * per_m, turned * Vec3(1, -1, -1) * per_m, turned * Vec3(-1, 1, -1) * per_m,
          turned * Vec3(-1, -1, 1) * per_m};
}

LatticeSpline::At ProceduralTexture::at(const Vec3& p_W) const noexcept {
  LatticeSpline::At sum;
  for (int i = 0; i < kWaves; ++i) {
    const double phase = waveVector(i).dot(p_W) + i;  // phases without a common divisor
    sum.value += std::sin(phase);
    sum.gradient_W += std::cos(phase) * waveVector(i);
  }
  return {amplitude_m_ / kWaves * sum.value, amplitude_m_ / kWaves * sum.gradient_W};
}

void ProceduralTexture::move(const ContactState& contact, ContactPush& push) noexcept {
  if (!(amplitude_m_ > 0)) return;
  raise(contact, at(contact.felt.place_W), amplitude_m_, push);
}

// ---- density ----

namespace {

struct Departure {
  double gain;
  double limit_m;
  double operator()(const SampleWindow& window, const Vec3i& i) const noexcept {
    const Sample& here = sampleAt(window, i);
    double mean = 0, steep = 0, weights = 0;
    for (int axis = 0; axis < 3; ++axis) {
      const double weight = 1 / (window.lattice.spacing_m[axis] * window.lattice.spacing_m[axis]);
      weights += 2 * weight;
      for (const int way : {-1, 1}) {
        Vec3i beside = i;
        beside[axis] = std::clamp(i[axis] + way, 0, window.size[axis] - 1);
        const Sample& there = sampleAt(window, beside);
        mean += weight * static_cast<double>(there.density);
        steep += weight * steepness2(there);
      }
    }
    const double steepness = std::sqrt(0.5 * (steepness2(here) + steep / weights));
    const double height_m = gain * (static_cast<double>(here.density) - mean / weights) / steepness;
    return std::isnan(height_m) || !(steepness > 0) ? 0 : std::clamp(height_m, -limit_m, limit_m);
  }
  static double steepness2(const Sample& s) noexcept {
    return Vec3(s.gradient_i, s.gradient_j, s.gradient_k).squaredNorm();
  }
};

}  // namespace

void DensityTexture::move(const ContactState& contact, ContactPush& push) noexcept {
  const FeltPoint& felt = contact.felt;
  if (felt.window == nullptr || !felt.now_W.allFinite()) return;
  const double amplitude_m = std::min(amplitude_m_, kWidest * felt.window->lattice.smallestSpacing());
  if (!(amplitude_m > 0)) return;
  raise(contact, field_.at(felt, 0, Departure{gain_, amplitude_m}), amplitude_m, push);
}

}  // namespace palpate
