// SPDX-License-Identifier: Apache-2.0
#include "servo/contact/texture.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace palpate {
namespace {

Vec3 raised(const ContactState& contact, const Vec3& vhip_W, double height_m, double amplitude_m) noexcept {
  const Vec3& normal_W = contact.plane.normal_W;
  const double depth_m = std::max(0.0, normal_W.dot(vhip_W - contact.hip_W));
  const double share = depth_m < amplitude_m ? depth_m / amplitude_m : 1;
  return vhip_W + normal_W * (height_m * share);
}

}  // namespace

// ---- procedural ----

ProceduralTexture::ProceduralTexture(double amplitude_m, double wavelength_m) noexcept : amplitude_m_(amplitude_m) {
  // Turned so that no wave lies within 28 degrees of an axis, nor do two look alike on a plane across one.
  const Mat3 turned = (Eigen::AngleAxisd(2.5, Vec3::UnitZ()) * Eigen::AngleAxisd(0.5, Vec3::UnitX()) *
                       Eigen::AngleAxisd(2.0, Vec3::UnitZ()))
                          .toRotationMatrix();
  const double per_m = 2 * std::numbers::pi / wavelength_m / std::sqrt(3.0);
  k_W_ = {turned * Vec3(1, 1, 1) * per_m, turned * Vec3(1, -1, -1) * per_m, turned * Vec3(-1, 1, -1) * per_m,
          turned * Vec3(-1, -1, 1) * per_m};
}

double ProceduralTexture::height(const Vec3& p_W) const noexcept {
  double sum = 0;
  for (int i = 0; i < kWaves; ++i) sum += std::sin(waveVector(i).dot(p_W) + i);  // phases that have no common divisor
  return amplitude_m_ / kWaves * sum;
}

Vec3 ProceduralTexture::move(const ContactState& contact, const Vec3& vhip_W) noexcept {
  return raised(contact, vhip_W, height(vhip_W), amplitude_m_);
}

// ---- density ----

double DensityTexture::departure(const WindowSampler& sampler, const Vec3& p_W, const Vec3& normal_W) const noexcept {
  const Fetch here = sampler.at(p_W);
  const double steepness = here.gradient_W.norm();
  if (here.place != Place::kInside || !(steepness > 0)) return 0;
  double sum = 0;
  for (int axis = 0; axis < 3; ++axis) {
    const Vec3 axis_W = sampler.faceNormal(axis, true);
    const Vec3 aside_W = (axis_W - normal_W * normal_W.dot(axis_W)) * sampler.smallestSpacing();
    for (const double sign : {-1.0, 1.0}) {
      const Fetch there = sampler.at(p_W + sign * aside_W);
      if (there.place != Place::kInside) return 0;
      sum += there.density;
    }
  }
  const double departure_m = (here.density - sum / 6) / steepness;
  return std::isfinite(departure_m) ? departure_m : 0;
}

Vec3 DensityTexture::move(const ContactState& contact, const Vec3& vhip_W) noexcept {
  const WindowSampler& sampler = window_.of(*contact.window);
  const double height_m = gain_ * departure(sampler, vhip_W, contact.plane.normal_W);
  return raised(contact, vhip_W, std::clamp(height_m, -amplitude_m_, amplitude_m_), amplitude_m_);
}

}  // namespace palpate
