// SPDX-License-Identifier: Apache-2.0
// servo/contact/surface_patch.hpp: the isosurface around a point, from the normals at the point and at six points
// around it: mean normal, curvature, and how uneven it is.
//
// The six points lie along the lattice's axes projected onto the tangent plane, so they turn continuously with the
// normal. A tip that presses deep feels only wide bumps, so their distance from the point grows with the depth: it is
// kSpread of it. But along each axis it is at least kLeastSpread voxels, measured along that axis, and at most
// kMostSpread. So where slices are 5 mm apart, points one slice away are used.
// - The mean normal is that of the sum of the seven gradients: steeper places count for more.
// - The curvature is the symmetric matrix S with dN = S dp that fits the three differences of normals best, in the
//   sense of least squares. On a ball it is 1 / R.
// - The offset is how far the mean surface lies in front of the point. The curvature alone would put the surface at a
//   point w aside by w S w / 2 behind the tangent plane, so it is given: that of one patch of a rough surface would add
//   as much noise as the mean takes away.
// - The unevenness is the root mean square by which a normal departs from that fit, per component along the surface
//   [rad]. On a smooth surface it is of third order; white noise of s voxels gives 0.7 s.
// Frame W: world [m]. Thread: the servo's. Cost: seven fetches, some 180 ns; curvature() some 50 ns more. Errors: none.
#pragma once

#include <array>

#include "servo/window/window_sampler.hpp"

namespace palpate {

class SurfacePatch {
 public:
  static constexpr double kSpread = 1.0 / 6;   // of the depth [-]
  static constexpr double kLeastSpread = 1.5;  // nearer, two points share most of their samples [voxel]
  static constexpr double kMostSpread = 4;     // farther, they lie on different features of the object [voxel]

  struct Width {
    double depth_m = 0;  // of the press [m]
    double wider = 0;    // 0 to 1: from the distance for that depth to the largest one [-]
  };

  // Around `p_W`, which is on the surface or near it, in a sampler that has a window. `normal_W`: about the normal
  // there.
  SurfacePatch(const WindowSampler& sampler, const Vec3& p_W, const Vec3& normal_W, const Width& width) noexcept;

  // From the point to the points ahead, for each axis [m].
  [[nodiscard]] const std::array<Vec3, 3>& ways() const noexcept { return aside_W_; }

  // Zero if the gradients sum to zero, or are not finite.
  [[nodiscard]] const Vec3& normal() const noexcept { return normal_W_; }
  [[nodiscard]] bool known() const noexcept { return !normal_W_.isZero(0); }

  struct Curvature {
    Mat3 S_W = Mat3::Zero();  // symmetric, zero along the normal [1/m]
    double unevenness = 0;    // [rad]
  };
  // Of a patch that is known. Pairs of points of which one has no normal, or one on another sheet, are left out.
  [[nodiscard]] Curvature curvature() const noexcept;
  // How far the mean of the surfaces at the seven points lies in front of the point, on a surface of curvature S_W [m].
  [[nodiscard]] double offset(double isovalue, const Mat3& S_W) const noexcept;

 private:
  std::array<Vec3, 3> aside_W_;      // from the point to one of each pair [m]
  std::array<Vec3, 7> gradients_W_;  // at the point, then pair by pair: ahead, behind
  std::array<double, 7> densities_;
  Vec3 normal_W_ = Vec3::Zero();
};

}  // namespace palpate
