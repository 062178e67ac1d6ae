// SPDX-License-Identifier: Apache-2.0
#include "servo/objects/shapes.hpp"

#include <algorithm>
#include <cmath>

#include "base/error.hpp"

namespace palpate {
namespace {

void check(bool good, const std::string& name, const char* reason, const char* remedy) {
  if (!good) throw Error(Error::Code::kBadInput, name, reason, remedy);
}

void checkFinite(const Vec3& v, const std::string& name) {
  check(v.allFinite(), name, "a position is not finite", "give finite millimetres");
}

}  // namespace

// ---- plane ----

PlaneObject::PlaneObject(const Vec3& p_W, const Vec3& normal_W, const std::string& name)
    : p_W_(p_W), normal_W_(normal_W.stableNormalized()) {
  checkFinite(p_W, name);
  check(normal_W.allFinite() && std::abs(normal_W_.norm() - 1) < 1e-6, name, "its normal has no direction",
        "give a normal that is not zero");
}

std::optional<ObjectEntry> PlaneObject::firstEntry(const Vec3& from_W, const Vec3& to_W) const noexcept {
  const double before_m = normal_W_.dot(from_W - p_W_);
  const double after_m = normal_W_.dot(to_W - p_W_);
  if (!(before_m >= 0 && after_m < 0)) return std::nullopt;
  const double share = before_m / (before_m - after_m);
  return ObjectEntry{share, {from_W + share * (to_W - from_W), normal_W_}};
}

ObjectPoint PlaneObject::nearest(const Vec3& x_W) const noexcept {
  return {x_W - normal_W_.dot(x_W - p_W_) * normal_W_, normal_W_};
}

// ---- sphere ----

SphereObject::SphereObject(const Vec3& centre_W, double radius_m, const std::string& name)
    : centre_W_(centre_W), radius_m_(radius_m) {
  checkFinite(centre_W, name);
  check(std::isfinite(radius_m) && radius_m > 0, name, "its radius is not positive", "give a radius above 0 mm");
}

// The smaller root of |from + share way - c|^2 = R^2, in the form that does not cancel (Press et al., section 5.6).
std::optional<ObjectEntry> SphereObject::firstEntry(const Vec3& from_W, const Vec3& to_W) const noexcept {
  const Vec3 way_W = to_W - from_W;
  const Vec3 arm_W = from_W - centre_W_;
  const double c = (arm_W.norm() - radius_m_) * (arm_W.norm() + radius_m_);
  const double b = arm_W.dot(way_W);
  if (!(c >= 0 && b < 0)) return std::nullopt;
  const double discriminant = b * b - way_W.squaredNorm() * c;
  if (!(discriminant > 0)) return std::nullopt;
  const double share = c / (std::sqrt(discriminant) - b);
  if (!(share < 1)) return std::nullopt;
  return ObjectEntry{share, nearest(from_W + share * way_W)};
}

ObjectPoint SphereObject::nearest(const Vec3& x_W) const noexcept {
  const Vec3 arm_W = x_W - centre_W_;
  const double distance_m = arm_W.norm();
  const Vec3 normal_W = distance_m > 0 ? Vec3(arm_W / distance_m) : Vec3(Vec3::UnitZ());
  return {centre_W_ + radius_m_ * normal_W, normal_W};
}

// ---- box ----

BoxObject::BoxObject(const Vec3& centre_W, const Vec3& size_m, const Mat3& R_WB, const std::string& name)
    : centre_W_(centre_W), half_m_(0.5 * size_m), R_WB_(R_WB) {
  checkFinite(centre_W, name);
  check(size_m.allFinite() && size_m.minCoeff() > 0, name, "an edge is not positive", "give three sizes above 0 mm");
  check((R_WB.transpose() * R_WB).isIdentity(1e-6), name, "its axes are not orthonormal", "give a rotation");
}

// The slab method (Kay and Kajiya 1986): inside all three slabs from the last one entered to the first one left.
std::optional<ObjectEntry> BoxObject::firstEntry(const Vec3& from_W, const Vec3& to_W) const noexcept {
  const Vec3 from_B = R_WB_.transpose() * (from_W - centre_W_);
  const Vec3 way_B = R_WB_.transpose() * (to_W - from_W);
  double enter = -1;
  double leave = 1;
  int face = -1;
  for (int axis = 0; axis < 3; ++axis) {
    if (way_B[axis] == 0) {
      if (std::abs(from_B[axis]) >= half_m_[axis]) return std::nullopt;
      continue;
    }
    const double side = way_B[axis] > 0 ? -1 : 1;  // of the slab's face through which the line enters
    const double in = (side * half_m_[axis] - from_B[axis]) / way_B[axis];
    const double out = (-side * half_m_[axis] - from_B[axis]) / way_B[axis];
    if (in > enter) {
      enter = in;
      face = axis;
    }
    leave = std::min(leave, out);
  }
  if (face < 0 || enter < 0 || !(enter < leave)) return std::nullopt;
  const Vec3 normal_W = R_WB_.col(face) * (way_B[face] > 0 ? -1.0 : 1.0);
  return ObjectEntry{enter, {from_W + enter * (to_W - from_W), normal_W}};
}

ObjectPoint BoxObject::nearest(const Vec3& x_W) const noexcept {
  const Vec3 x_B = R_WB_.transpose() * (x_W - centre_W_);
  Vec3 p_B = x_B.cwiseMax(-half_m_).cwiseMin(half_m_);
  Vec3 normal_B = x_B - p_B;
  if (normal_B.squaredNorm() > 0) {
    normal_B.normalize();
  } else {
    int axis = 0;
    (half_m_ - x_B.cwiseAbs()).minCoeff(&axis);
    normal_B = Vec3::Unit(axis) * (x_B[axis] < 0 ? -1.0 : 1.0);
    p_B[axis] = normal_B[axis] * half_m_[axis];
  }
  return {centre_W_ + R_WB_ * p_B, R_WB_ * normal_B};
}

}  // namespace palpate
