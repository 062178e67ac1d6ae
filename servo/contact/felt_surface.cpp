// SPDX-License-Identifier: Apache-2.0
#include "servo/contact/felt_surface.hpp"

#include <algorithm>
#include <cmath>

namespace palpate {
namespace {

// The first patch of a contact is trusted as if the tool had slid so far already. Less makes the first ticks of a
// contact chatter, more keeps an error of that patch for longer [voxel].
constexpr double kFirstSeen = 0.5;
// In a groove the surface point errs besides by what an uneven normal does over so many voxels: the sampled surface's
// own error, without a press.
constexpr double kPointArm = 2;
// From this much roughness on, one over it, the depth is that under the mean of the patch's seven points. Below it is
// that under the plane, in proportion [-].
constexpr double kMeanOffset = 3;
// The share of its way that the roughness goes in a voxel [-].
constexpr double kFollow = 0.5;

// The part along the normal taken out on both sides.
Mat3 tangentialPart(const Mat3& S_W, const Vec3& normal_W) noexcept {
  const Mat3 P = Mat3::Identity() - normal_W * normal_W.transpose();
  return P * S_W * P;
}

// A normal cut to kMostApart from that of the plane.
Vec3 notFarFrom(const Vec3& plane_W, const Vec3& normal_W) noexcept {
  const double along = normal_W.dot(plane_W);
  const Vec3 aside_W = normal_W - along * plane_W;
  const double aside = aside_W.norm();
  if (!(aside > FeltSurface::kMostApart * along) || !(aside > 0)) return normal_W;
  return (plane_W + aside_W * (FeltSurface::kMostApart / aside)).normalized();
}

}  // namespace

FeltSurface::FeltSurface(double isovalue, double rate_hz) noexcept
    : isovalue_(isovalue), rest_voxels_(kRest / rate_hz), normal_ahead_W_(rate_hz), bend_ahead_W_(rate_hz) {}

void FeltSurface::release() noexcept {
  known_ = false;
  window_.forget();
}

void FeltSurface::begin(const Contact& contact) noexcept {
  known_ = true;
  form_ = {contact.plane.normal_W, Mat3::Zero()};
  normal_ahead_W_.end();
  bend_ahead_W_.end();
  depth_m_ = contact.plane.depth(contact.hip_W);
  lever_ = slid_voxels_ = 0;
  felt_.roughness = 0;
}

// The tool has moved over the surface as far as its curvature is known.
void FeltSurface::predict(const Vec3& way_W) noexcept {
  const ShapeOperator shape(form_.normal_W, form_.S_W);
  const Vec3 slid_W = shape.slopeAtHip(way_W, depth_m_);
  most_way_m_ = kMostAhead * std::max(way_W.norm(), slid_W.norm());
  form_.normal_W = (form_.normal_W + shape.apply(slid_W)).normalized();
  depth_m_ -= form_.normal_W.dot(way_W);
}

FeltSurface::Way FeltSurface::wayOf(const WindowSampler& sampler, const Vec3& way_W,
                                    const ContactPlane& plane) const noexcept {
  return {std::sqrt(sampler.squaredVoxels(way_W)) + rest_voxels_,
          std::sqrt(sampler.squaredVoxels(way_W - plane.normal_W * plane.normal_W.dot(way_W)))};
}

// Where the line from the HIP along the felt normal meets the volume's plane, not farther aside than the depth.
Vec3 FeltSurface::footOf(const Contact& contact) const noexcept {
  const Vec3& plane_W = contact.plane.normal_W;
  const double whole_m = contact.plane.depth(contact.hip_W) + contact.eased_m;
  Vec3 below_tool_W = contact.plane.nearest(contact.hip_W) + contact.eased_m * plane_W;
  const double cosine = form_.normal_W.dot(plane_W);
  if (!(cosine > 0)) return below_tool_W;
  const Vec3 aside_W = whole_m / cosine * (form_.normal_W - cosine * plane_W);
  const double aside_m = aside_W.norm(), longest_m = kMostAside * whole_m;
  return below_tool_W + (aside_m > longest_m ? Vec3(aside_W * (longest_m / aside_m)) : aside_W);
}

// The patch at the foot, and the lever of what is uneven there.
FeltSurface::Measure FeltSurface::measure(const WindowSampler& sampler, const Contact& contact,
                                          const Way& way) noexcept {
  const Vec3& plane_W = contact.plane.normal_W;
  Measure measured{{plane_W, form_.S_W}, contact.plane.depth(contact.hip_W), 0};
  const double whole_m = measured.depth_m + contact.eased_m;
  lever_ *= std::max(0.0, 1 - way.voxels / kForget);
  const Vec3 foot_W = footOf(contact);
  if (sampler.place(foot_W) != Place::kInside) return measured;
  const SurfacePatch patch(sampler, foot_W, form_.normal_W, {.depth_m = whole_m, .wider = felt_.roughness});
  if (!patch.known() || !(patch.normal().dot(plane_W) > 0)) return measured;
  const SurfacePatch::Curvature curvature = patch.curvature();
  measured.form = {patch.normal(), curvature.S_W};
  measured.offset_m = patch.offset(isovalue_, trust_ * form_.S_W);
  felt_.patch_W = patch.ways();
  const double arm = whole_m / sampler.smallestSpacing() + (contact.sharpness > 1 ? kPointArm : 0);
  lever_ = std::max(lever_, contact.sharpness * arm * curvature.unevenness);
  return measured;
}

// Smooths what was measured over the way of the tool.
void FeltSurface::takeIn(const Measure& measured, const Way& way, const Vec3& plane_W) noexcept {
  const double length = std::clamp(kSmoothed * (lever_ - kLeastLever), 0.0, kLongest);
  felt_.roughness += kFollow * std::min(1.0, way.voxels) * (length / kLongest - felt_.roughness);
  // What was seen since the contact began is all that there is to smooth with.
  slid_voxels_ += way.aside_voxels;
  const double seen_voxels = std::min(kFirstSeen + slid_voxels_, 2 * kLongest);
  trust_ = seen_voxels / (seen_voxels + 2 * length);
  const double share = way.voxels / (way.voxels + std::min(length, seen_voxels));
  const double slow = way.voxels / (way.voxels + std::min(2 * length, seen_voxels));
  const Vec3 turn_W = share * (measured.form.normal_W - form_.normal_W);
  const Mat3 bend_W = slow * (measured.form.S_W - form_.S_W);
  form_.normal_W = (form_.normal_W + turn_W).normalized();
  form_.normal_W = notFarFrom(plane_W, form_.normal_W);
  form_.S_W = tangentialPart(form_.S_W + bend_W, form_.normal_W);
  const double mean_m = std::min(1.0, kMeanOffset * felt_.roughness) * measured.offset_m;
  depth_m_ += share * (measured.depth_m + mean_m - depth_m_);
  if (!felt_.edited) return;
  normal_ahead_W_.take(turn_W);
  bend_ahead_W_.take(bend_W);
}

void FeltSurface::tell(const Contact& contact, bool begins) noexcept {
  Form felt = form_;
  if (normal_ahead_W_.active()) felt.normal_W = (form_.normal_W - normal_ahead_W_.elapse()).normalized();
  if (bend_ahead_W_.active()) felt.S_W -= bend_ahead_W_.elapse();
  felt_.normal_W = felt.normal_W;
  felt_.depth_m = std::max(0.0, depth_m_);
  felt_.p_W = contact.hip_W + felt_.depth_m * felt.normal_W;
  const Vec3 to_p_W = felt_.p_W - felt_.place_W;
  const double way_m = to_p_W.norm();
  felt_.place_W = begins || !(way_m > most_way_m_) ? felt_.p_W : Vec3(felt_.place_W + to_p_W * (most_way_m_ / way_m));
  felt_.now_W = felt_.place_W + contact.eased_m * contact.plane.normal_W;
  felt_.shape = ShapeOperator(felt.normal_W, trust_ * felt.S_W);
  felt_.window = contact.on_volume && contact.window->usable() ? contact.window : nullptr;
}

const FeltPoint& FeltSurface::feel(const Contact& contact) noexcept {
  const Vec3 way_W = contact.hip_W - last_hip_W_;
  last_hip_W_ = contact.hip_W;
  const bool usable = contact.window->usable();
  const bool begins = contact.begins || !known_ || !contact.on_volume || !isTickMotion(way_W);
  felt_.edited = !begins && usable && contact.window->edit_version != edit_version_;
  if (usable) edit_version_ = contact.window->edit_version;
  if (begins) {
    begin(contact);
  } else {
    predict(way_W);
  }
  known_ = contact.on_volume && usable;
  if (contact.on_volume && usable) {
    const WindowSampler& sampler = window_.of(*contact.window);
    const Way way = wayOf(sampler, begins ? Vec3::Zero() : way_W, contact.plane);
    takeIn(measure(sampler, contact, way), way, contact.plane.normal_W);
  }
  tell(contact, begins);
  return felt_;
}

}  // namespace palpate
