// SPDX-License-Identifier: Apache-2.0
// The nearest point on an ellipse or ellipsoid: x_i = a_i^2 p_i / (t + a_i^2) with the largest root t of
// sum (a_i p_i / (t + a_i^2))^2 = 1. As a function of s = t + min a^2, the sum is convex and falls for s > 0. So
// Newton's method, started left of the root, climbs to it without overshoot. Source: Eberly, "Distance from a point to
// an ellipse, an ellipsoid, or a hyperellipsoid" (Geometric Tools, 2013).
#include <cmath>

#include "engine/phantoms/solid.hpp"

namespace palpate {
namespace {

template <int N>
using VecN = Eigen::Matrix<double, N, 1>;

template <int N>
struct Nearest {
  VecN<N> point;
  bool inside;
};

// `p` in the first orthant, all coordinates above 0. Returns s.
template <int N>
double solveForS(const VecN<N>& p, const VecN<N>& a) {
  constexpr int kMaxSteps = 100;  // 5 to 8 are the rule
  const double smallest = a.minCoeff();
  const VecN<N> excess = a.cwiseProduct(a).array() - smallest * smallest;  // exactly 0 for the smallest axis
  const VecN<N> ap = a.cwiseProduct(p);
  double s = (ap - excess).maxCoeff();  // one term is 1 there, so the sum is at least 1
  for (int step = 0; step < kMaxSteps; ++step) {
    const VecN<N> ratio = ap.array() / (excess.array() + s);
    const double value = ratio.squaredNorm() - 1;
    const double slope = -2 * (ratio.array().square() / (excess.array() + s)).sum();
    const double next = s - value / slope;
    if (!(next > s)) break;  // rounding has the last word
    s = next;
  }
  return s;
}

template <int N>
Nearest<N> nearestOnEllipsoid(const VecN<N>& p, const VecN<N>& a) {
  // On a plane of symmetry there may be two nearest points. A nudge of 1e-15 chooses one and moves it no farther.
  const VecN<N> q = p.cwiseAbs().cwiseMax(a * 1e-15);
  const double s = solveForS<N>(q, a);
  const VecN<N> a2 = a.cwiseProduct(a);
  const double smallest = a.minCoeff();
  VecN<N> x = a2.cwiseProduct(q).cwiseQuotient((a2.array() - smallest * smallest + s).matrix());
  for (int axis = 0; axis < N; ++axis) x[axis] = std::copysign(x[axis], p[axis]);
  return {x, p.cwiseQuotient(a).squaredNorm() < 1};
}

template <int N>
SurfaceOffset ellipsoidOffsetN(const VecN<N>& p, const VecN<N>& a) {
  const Nearest<N> nearest = nearestOnEllipsoid<N>(p, a);
  const double distance_m = (p - nearest.point).norm();
  Vec3 normal = Vec3::Zero();
  normal.template head<N>() = nearest.point.cwiseQuotient(a.cwiseProduct(a)).normalized();
  return {nearest.inside ? -distance_m : distance_m, normal};
}

}  // namespace

SurfaceOffset ellipsoidOffset(const Vec3& p_W, const Vec3& centre_W, const Vec3& semi_axes_m) {
  return ellipsoidOffsetN<3>(p_W - centre_W, semi_axes_m);
}

SurfaceOffset ellipticCylinderOffset(const Vec3& p_W, const Vec3& centre_W, double semi_x_m, double semi_y_m) {
  return ellipsoidOffsetN<2>((p_W - centre_W).head<2>(), Eigen::Vector2d(semi_x_m, semi_y_m));
}

}  // namespace palpate
