// SPDX-License-Identifier: Apache-2.0
#include "servo/contact/shape_operator.hpp"

#include <algorithm>
#include <cmath>

namespace palpate {
ShapeOperator::ShapeOperator(const Vec3& normal_W) noexcept {
  int least = 0;
  normal_W.cwiseAbs().minCoeff(&least);
  u_W_ = normal_W.cross(Vec3::Unit(least)).normalized();
  v_W_ = normal_W.cross(u_W_);
}

ShapeOperator::ShapeOperator(const Vec3& normal_W, const Mat3& S_W) noexcept : ShapeOperator(normal_W) {
  const Vec3 along_u_W = S_W * u_W_;
  uu_ = u_W_.dot(along_u_W);
  uv_ = v_W_.dot(along_u_W);
  vv_ = v_W_.dot(S_W * v_W_);
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
