// SPDX-License-Identifier: Apache-2.0
#include "servo/contact/felt_surface.hpp"

#include <algorithm>
#include <cmath>

#include "servo/contact/edit_ease.hpp"

namespace palpate {
namespace {

constexpr double kPatch = 0.5;      // what the first patch of a contact counts as [voxel]
constexpr double kPointLevers = 2;  // in a groove: the point errs by as much as an angle over so many voxels
constexpr double kMeanPoint = 3;    // times the roughness: share of the mean of the points in the depth [-]
constexpr double kRougher = 0.5;    // share by which the roughness follows over a voxel [-]

// The part along the normal taken out on both sides.
Mat3 tangentialPart(const Mat3& S_W, const Vec3& normal_W) noexcept {
  const Mat3 P = Mat3::Identity() - normal_W * normal_W.transpose();
  return P * S_W * P;
}

}  // namespace

FeltSurface::FeltSurface(double isovalue, double rate_hz) noexcept
    : isovalue_(isovalue),
      rest_voxels_(kRest / rate_hz),
      ease_ticks_(std::max(1.0, std::round(EditEase::kTime_s * rate_hz))) {}

void FeltSurface::release() noexcept {
  known_ = false;
  window_.forget();
}

void FeltSurface::begin(const Contact& contact) noexcept {
  known_ = true;
  form_ = {contact.plane.normal_W, Mat3::Zero()};
  ahead_ = {};
  ahead_ticks_ = 0;
  depth_m_ = contact.plane.depth(contact.hip_W);
  lever_ = slid_voxels_ = 0;
  trust_ = 1;
  felt_.roughness = 0;
}

// The tool has moved over the surface as far as its curvature is known.
void FeltSurface::predict(const Vec3& way_W) noexcept {
  const ShapeOperator shape(form_.normal_W, form_.S_W);
  form_.normal_W = (form_.normal_W + shape.apply(shape.slopeAtHip(way_W, depth_m_))).normalized();
  depth_m_ -= form_.normal_W.dot(way_W);
}

void FeltSurface::measure(const Contact& contact, const Vec3& way_W) noexcept {
  const WindowSampler& sampler = window_.of(*contact.window);
  const double way_voxels = std::sqrt(sampler.squaredVoxels(way_W)) + rest_voxels_;
  const double aside_voxels =
      std::sqrt(sampler.squaredVoxels(way_W - contact.plane.normal_W * contact.plane.normal_W.dot(way_W)));
  const Vec3& plane_W = contact.plane.normal_W;
  const double depth_m = contact.plane.depth(contact.hip_W);
  const double whole_m = depth_m + contact.eased_m;
  // Where the felt normal meets the plane.
  const double cosine = form_.normal_W.dot(plane_W);
  Vec3 aside_W = Vec3::Zero();
  if (cosine > 0) {
    aside_W = whole_m / cosine * (form_.normal_W - cosine * plane_W);
    const double aside_m = aside_W.norm();
    if (aside_m > kSteepest * whole_m) aside_W *= kSteepest * whole_m / aside_m;
  }
  const Vec3 foot_W = contact.plane.nearest(contact.hip_W) + contact.eased_m * plane_W + aside_W;
  Vec3 normal_W = plane_W;
  Mat3 S_W = form_.S_W;
  double offset_m = 0;
  lever_ *= std::max(0.0, 1 - way_voxels / kForget);
  if (sampler.place(foot_W) == Place::kInside) {
    const double spread = SurfacePatch::spreadOf(whole_m / sampler.smallestSpacing());
    const SurfacePatch patch(sampler, foot_W, form_.normal_W,
                             spread + felt_.roughness * (SurfacePatch::kMostSpread - spread));
    if (patch.known() && patch.normal().dot(plane_W) > 0) {
      const SurfacePatch::Curvature curvature = patch.curvature();
      normal_W = patch.normal();
      S_W = curvature.S_W;
      offset_m = patch.offset(isovalue_, trust_ * form_.S_W);
      felt_.patch_W = patch.ways();
      const double levers = whole_m / sampler.smallestSpacing() + (contact.sharpness > 1 ? kPointLevers : 0);
      lever_ = std::max(lever_, contact.sharpness * levers * curvature.unevenness);
    }
  }
  const double length = std::clamp(kSmoothed * (lever_ - kSmooth), 0.0, kLongest);
  felt_.roughness += kRougher * std::min(1.0, way_voxels) * (length / kLongest - felt_.roughness);
  // What was seen since the contact began is all that there is to smooth with.
  slid_voxels_ += aside_voxels;
  const double seen_voxels = std::min(kPatch + slid_voxels_, 2 * kLongest);
  trust_ = seen_voxels / (seen_voxels + 2 * length);
  const double share = way_voxels / (way_voxels + std::min(length, seen_voxels));
  const double slow = way_voxels / (way_voxels + std::min(2 * length, seen_voxels));
  const Vec3 turn_W = share * (normal_W - form_.normal_W);
  const Mat3 bend_W = slow * (S_W - form_.S_W);
  form_.normal_W = (form_.normal_W + turn_W).normalized();
  form_.S_W = tangentialPart(form_.S_W + bend_W, form_.normal_W);
  depth_m_ += share * (depth_m + std::min(1.0, kMeanPoint * felt_.roughness) * offset_m - depth_m_);
  if (felt_.edited) {
    ahead_.normal_W += turn_W;
    ahead_.S_W += bend_W;
    ahead_ticks_ = ease_ticks_;
  }
}

void FeltSurface::tell(const Contact& contact) noexcept {
  Form felt = form_;
  if (ahead_ticks_ > 0) {
    const double left = 1 - 1 / ahead_ticks_;
    ahead_.normal_W *= left;
    ahead_.S_W *= left;
    --ahead_ticks_;
    felt.normal_W = (form_.normal_W - ahead_.normal_W).normalized();
    felt.S_W -= ahead_.S_W;
  }
  felt_.normal_W = felt.normal_W;
  felt_.depth_m = std::max(0.0, depth_m_);
  felt_.p_W = contact.hip_W + felt_.depth_m * felt.normal_W;
  felt_.now_W = felt_.p_W + contact.eased_m * contact.plane.normal_W;
  felt_.shape = ShapeOperator(felt.normal_W, trust_ * felt.S_W);
  felt_.window = contact.on_volume && contact.window->usable() ? contact.window : nullptr;
}

const FeltPoint& FeltSurface::feel(const Contact& contact) noexcept {
  const Vec3 way_W = contact.hip_W - last_hip_W_;
  last_hip_W_ = contact.hip_W;
  if (contact.begins || !known_ || !contact.on_volume || !isTickMotion(way_W)) {
    begin(contact);
    edit_version_ = contact.window->edit_version;
    felt_.edited = false;
    if (contact.on_volume) measure(contact, Vec3::Zero());
    tell(contact);
    known_ = contact.on_volume;
    return felt_;
  }
  const bool usable = contact.window->usable();
  felt_.edited = usable && contact.window->edit_version != edit_version_;
  if (usable) edit_version_ = contact.window->edit_version;
  predict(way_W);
  measure(contact, way_W);
  tell(contact);
  return felt_;
}

}  // namespace palpate
