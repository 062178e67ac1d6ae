// SPDX-License-Identifier: Apache-2.0
#include "servo/contact/surface_patch.hpp"

#include <algorithm>
#include <cmath>

#include <Eigen/LU>

namespace palpate {
namespace {

using Tangents = Eigen::Matrix<double, 3, 2>;

// The symmetric X with X A + A X = C, for symmetric A and C of two rows.
Eigen::Matrix2d solveSymmetric(const Eigen::Matrix2d& A, const Eigen::Matrix2d& C) noexcept {
  const Eigen::Matrix2d adjugate = A.trace() * Eigen::Matrix2d::Identity() - A;
  return (A.determinant() * C + adjugate * C * adjugate) / (2 * A.trace() * A.determinant());
}

}  // namespace

SurfacePatch::SurfacePatch(const WindowSampler& sampler, const Vec3& p_W, const Vec3& normal_W,
                           const Width& width) noexcept {
  const Fetch middle = sampler.at(p_W);
  gradients_W_[0] = middle.gradient_W;
  densities_[0] = middle.density;
  Vec3 uphill_W = middle.gradient_W;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const Vec3 axis_W = sampler.faceNormal(static_cast<int>(axis), true);
    const Vec3 along_W = axis_W - normal_W * normal_W.dot(axis_W);
    const double voxel_m = sampler.voxelAlong(along_W);
    const double narrow = std::clamp(kSpread * width.depth_m / voxel_m, kLeastSpread, kMostSpread);
    const double spread_voxels = narrow + width.wider * (kMostSpread - narrow);
    aside_W_[axis] = along_W * (spread_voxels * voxel_m);
    for (const int way : {1, -1}) {
      const std::size_t i = 2 * axis + (way > 0 ? 1 : 2);
      const Fetch there = sampler.at(p_W + way * aside_W_[axis]);
      gradients_W_[i] = there.gradient_W.allFinite() ? there.gradient_W : Vec3::Zero();
      densities_[i] = there.density;
      uphill_W += gradients_W_[i];
    }
  }
  const double length = uphill_W.norm();
  if (length > 0 && std::isfinite(length)) normal_W_ = uphill_W / -length;
}

SurfacePatch::Curvature SurfacePatch::curvature() const noexcept {
  Tangents tangents;
  int least = 0;
  normal_W_.cwiseAbs().minCoeff(&least);
  tangents.col(0) = normal_W_.cross(Vec3::Unit(least)).normalized();
  tangents.col(1) = normal_W_.cross(tangents.col(0));

  // Half the sum and half the difference of the normals of a pair; for the smooth surface that fits best the first is
  // the normal at the point, the second S times the way.
  struct Pair {
    Eigen::Vector2d way_m, mean, turn;
    double weight;
  };
  std::array<Pair, 3> pairs;
  std::size_t count = 0;
  Eigen::Matrix2d A = Eigen::Matrix2d::Zero(), C = Eigen::Matrix2d::Zero();
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const Vec3 &ahead_W = gradients_W_[2 * axis + 1], &behind_W = gradients_W_[2 * axis + 2];
    const double a = ahead_W.norm(), b = behind_W.norm();
    if (!(a > 0) || !(b > 0) || !(ahead_W.dot(normal_W_) < 0) || !(behind_W.dot(normal_W_) < 0)) continue;
    const Vec3 n_ahead_W = ahead_W / -a, n_behind_W = behind_W / -b;
    Pair& pair = pairs[count++];
    pair = {tangents.transpose() * aside_W_[axis], tangents.transpose() * (0.5 * (n_ahead_W + n_behind_W)),
            tangents.transpose() * (0.5 * (n_ahead_W - n_behind_W)), std::min(a, b)};
    A += pair.weight * pair.way_m * pair.way_m.transpose();
    C += pair.weight * (pair.turn * pair.way_m.transpose() + pair.way_m * pair.turn.transpose());
  }
  Curvature result;
  if (!(A.determinant() > 1e-6 * A.trace() * A.trace())) return result;
  const Eigen::Matrix2d S = solveSymmetric(A, C);
  double squares = 0, weights = 0;
  for (std::size_t i = 0; i < count; ++i) {
    squares += pairs[i].weight * ((pairs[i].turn - S * pairs[i].way_m).squaredNorm() + pairs[i].mean.squaredNorm());
    weights += pairs[i].weight;
  }
  // Each of three pairs has two components of half a variance in its mean and two in its turn; S takes three of these.
  constexpr double kExpected = (3 * 2 * 0.5 + 3 * 2 * 0.5 - 3 * 0.5) / 3;
  result.S_W = tangents * S * tangents.transpose();
  result.unevenness = std::sqrt(squares / weights / kExpected);
  return result;
}

double SurfacePatch::offset(double isovalue, const Mat3& S_W) const noexcept {
  const double farthest_m = aside_W_[0].norm() + aside_W_[1].norm() + aside_W_[2].norm();
  double sum_m = 0;
  int places = 0;
  for (std::size_t i = 0; i < gradients_W_.size(); ++i) {
    const double steepness = -gradients_W_[i].dot(normal_W_);
    const double offset_m = (densities_[i] - isovalue) / steepness;
    if (!(steepness > 0) || !(std::abs(offset_m) <= farthest_m)) continue;
    const Vec3 way_W = i == 0 ? Vec3::Zero() : aside_W_[(i - 1) / 2];
    sum_m += offset_m + 0.5 * way_W.dot(S_W * way_W);
    ++places;
  }
  return places > 0 ? sum_m / places : 0;
}

}  // namespace palpate
