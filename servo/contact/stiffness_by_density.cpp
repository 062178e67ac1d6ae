// SPDX-License-Identifier: Apache-2.0
#include "servo/contact/stiffness_by_density.hpp"

#include <algorithm>

namespace palpate {

void StiffnessByDensity::move(const ContactState& contact, ContactPush& push) noexcept {
  if (contact.new_contact) factor_ = 1;
  if (!contact.on_volume) return;
  Slope slope;
  const FeltPoint& felt = contact.felt;
  if (felt.window != nullptr && felt.now_W.allFinite()) slope = slopeAtHip(felt);
  // What is softer than K is so for all of the contact. What is added to K is added to the felt surface: it does not
  // jump where the plane does. So the energy there counts for the slope, too, on either side of a factor of 1.
  const double softer = std::min(1.0, factor_), harder = std::max(0.0, factor_ - 1);
  const double depth_m = contact.plane.depth(contact.hip_W);
  const Vec3 d_W = push.vhip_W - contact.hip_W;
  const Vec3 felt_d_W = d_W + felt.depth_m * felt.normal_W - push.surface_d_W;
  const double felt_m2 = std::max(0.0, push.energy_m2 + 0.5 * (felt.depth_m * felt.depth_m - depth_m * depth_m));
  push.vhip_W =
      contact.hip_W + softer * d_W + harder * felt_d_W - felt_m2 / (1 + felt_m2 * slope.bend_per_m2) * slope.along_W;
  push.energy_m2 = softer * push.energy_m2 + harder * felt_m2;
  push.stiffness *= factor_;
}

// The density is read at a = p - b(N) N, with b = below_m. As p moves, so do N and b: da = dp - (b + N grad_N b) dN, dN
// = S dp.
StiffnessByDensity::Slope StiffnessByDensity::slopeAtHip(const FeltPoint& felt) noexcept {
  const Lattice& lattice = felt.window->lattice;
  const Vec3& normal_W = felt.normal_W;
  const double below_m = kBelow * voxelAcross(lattice, normal_W);
  const LatticeSpline::At at = field_.at(felt, below_m, [this](const SampleWindow& window, const Vec3i& i) {
    return table_.factor(static_cast<double>(sampleAt(window, i).density));
  });
  factor_ = at.value;
  if (at.gradient_W.isZero(0)) return {};
  const Vec3 sides2_W =
      lattice.R_WL * (lattice.R_WL.transpose() * normal_W).cwiseProduct(lattice.spacing_m.cwiseAbs2());
  const Vec3 below_by_normal_W = sides2_W * (kBelow * kBelow / below_m);  // grad_N b
  const Vec3 along_W =
      at.gradient_W - felt.shape.apply(below_m * at.gradient_W + below_by_normal_W * normal_W.dot(at.gradient_W));
  // The surface point moves faster than the tool, as often as the slope grows; f then bends by the square of that.
  const Vec3 at_hip_W = felt.shape.slopeAtHip(along_W, felt.depth_m);
  const Vec3 at_surface_W = felt.shape.slopeAtHip(along_W, 0);
  const double side_m = lattice.smallestSpacing(), slope2 = at_surface_W.squaredNorm();
  const double growth2 = slope2 > 0 ? at_hip_W.squaredNorm() / slope2 : 1;
  return {at_hip_W, bend_ * growth2 / (side_m * side_m)};
}

}  // namespace palpate
