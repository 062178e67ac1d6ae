// SPDX-License-Identifier: Apache-2.0
#include "servo/contact/shape_operator.hpp"

#include <algorithm>
#include <cmath>
#include <optional>

namespace palpate {
namespace {

std::optional<Vec3> normalAt(const WindowSampler& sampler, const Vec3& p_W) noexcept {
  const Fetch f = sampler.at(p_W);
  const double steepness = f.gradient_W.norm();
  if (f.place != Place::kInside || !(steepness > 0) || !std::isfinite(steepness)) return std::nullopt;
  return Vec3(f.gradient_W / -steepness);
}

}  // namespace

ShapeOperator::ShapeOperator(const Vec3& normal_W) noexcept {
  int least = 0;
  normal_W.cwiseAbs().minCoeff(&least);
  setTangents(normal_W, Vec3::Unit(least));
}

// The tangents are taken from the lattice, so they turn with the volume.
ShapeOperator::ShapeOperator(const WindowSampler& sampler, const Vec3& p_W, const Vec3& normal_W) noexcept
    : ShapeOperator(normal_W) {
  if (sampler.place(p_W) != Place::kInside) return;
  int least = 0;
  const auto along_axis = [&](int axis) { return std::abs(sampler.faceNormal(axis, true).dot(normal_W)); };
  for (int axis = 1; axis < 3; ++axis) least = along_axis(axis) < along_axis(least) ? axis : least;
  setTangents(normal_W, sampler.faceNormal(least, true));
  Vec3 along[2];
  for (int i = 0; i < 2; ++i) {
    const Vec3& tangent_W = i == 0 ? u_W_ : v_W_;
    const double step_m = 1 / (sampler.toIndex(p_W + tangent_W) - sampler.toIndex(p_W)).norm();
    const auto ahead = normalAt(sampler, p_W + step_m * tangent_W);
    const auto behind = normalAt(sampler, p_W - step_m * tangent_W);
    if (!ahead || !behind) return;
    along[i] = (*ahead - *behind) / (2 * step_m);
  }
  uu_ = u_W_.dot(along[0]);
  vv_ = v_W_.dot(along[1]);
  uv_ = 0.5 * (v_W_.dot(along[0]) + u_W_.dot(along[1]));
}

void ShapeOperator::setTangents(const Vec3& normal_W, const Vec3& other_W) noexcept {
  u_W_ = normal_W.cross(other_W).normalized();
  v_W_ = normal_W.cross(u_W_);
}

Vec3 ShapeOperator::apply(const Vec3& v_W) const noexcept {
  const double u = u_W_.dot(v_W), v = v_W_.dot(v_W);
  return u_W_ * (uu_ * u + uv_ * v) + v_W_ * (uv_ * u + vv_ * v);
}

// The symmetric 2x2 matrix I - D S has the eigenvalues mean +- radius. Its inverse has the inverse eigenvalues and the
// same axes.
Vec3 ShapeOperator::slopeAtHip(const Vec3& q_W, double depth_m) const noexcept {
  const double mean = 1 - 0.5 * depth_m * (uu_ + vv_);
  const double half = -0.5 * depth_m * (uu_ - vv_), mixed = -depth_m * uv_;
  const double radius = std::hypot(half, mixed);
  const double high = 1 / std::max(mean + radius, 1 / kMostGrowth), low = 1 / std::max(mean - radius, 1 / kMostGrowth);
  const double even = 0.5 * (high + low), odd = radius > 0 ? 0.5 * (high - low) / radius : 0;
  const double u = u_W_.dot(q_W), v = v_W_.dot(q_W);
  return u_W_ * (even * u + odd * (half * u + mixed * v)) + v_W_ * (even * v + odd * (mixed * u - half * v));
}

}  // namespace palpate
