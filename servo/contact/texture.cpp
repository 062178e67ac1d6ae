// SPDX-License-Identifier: Apache-2.0
#include "servo/contact/texture.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace palpate {
namespace {

struct Share {
  double value;  // s
  double per_m;  // s'
};

// `bend_per_m`: the largest of the height.
Share shareAt(double depth_m, double amplitude_m, double bend_per_m) noexcept {
  if (depth_m < 2 * amplitude_m) {
    const double u = depth_m / (2 * amplitude_m);
    return {u * (2 - u), (1 - u) / amplitude_m};
  }
  // D s is at most sqrt(w^2 + 4A^2), so D' s = (D + h s) s is at most A more: one over the bend.
  const double most_m = 1 / bend_per_m - amplitude_m;
  const double fall_m = std::sqrt(most_m * most_m - 4 * amplitude_m * amplitude_m);  // w
  const double x = (depth_m - 2 * amplitude_m) / fall_m;
  const double share = 1 / std::sqrt(1 + x * x);
  return {share, -x * share * share * share / fall_m};
}

// `bend_per_m2`: the largest bend of height / amplitude.
void raise(const ContactState& contact, const LatticeSpline::At& height, double amplitude_m, double bend_per_m2,
           ContactPush& push) noexcept {
  const Vec3& normal_W = contact.felt.normal_W;
  const double depth_m = contact.felt.depth_m;
  if (!(depth_m > 0)) return;
  const Share share = shareAt(depth_m, amplitude_m, amplitude_m * bend_per_m2);
  const double raised_m = depth_m + height.value * share.value;
  const Vec3 slope_W = contact.felt.shape.slopeAtHip(height.gradient_W, depth_m);
  push.vhip_W += normal_W * (raised_m * (1 + height.value * share.per_m) - depth_m) - raised_m * share.value * slope_W;
  push.energy_m2 += 0.5 * (raised_m * raised_m - depth_m * depth_m);
}

}  // namespace

// ---- procedural ----

ProceduralTexture::ProceduralTexture(double amplitude_m, double wavelength_m) noexcept
    : bend_per_m2_(4 * std::numbers::pi * std::numbers::pi / (3 * wavelength_m * wavelength_m)),
      amplitude_m_(std::min(amplitude_m, kWidestByBend / std::sqrt(bend_per_m2_))) {
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
  raise(contact, at(contact.felt.place_W), amplitude_m_, bend_per_m2_, push);
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
  const double side_m = felt.window->lattice.smallestSpacing();
  const double amplitude_m = std::min(amplitude_m_, kWidest * side_m);
  if (!(amplitude_m > 0)) return;
  const LatticeSpline::At height = field_.at(felt, 0, Departure{gain_, amplitude_m});
  raise(contact, height, amplitude_m, LatticeSpline::kMostBend / (side_m * side_m), push);
}

}  // namespace palpate
