// SPDX-License-Identifier: Apache-2.0
// apps/extreme/ground.hpp: the usual ground of the extreme cases: a plane that the samples hold exactly but for
// rounding to float, and a hand that presses on it. World frame W [m]. Any thread.
#pragma once

#include <functional>
#include <memory>

#include "apps/extreme/judge.hpp"
#include "apps/extreme/rough_run.hpp"

namespace palpate {

using SampledVolumePtr = std::shared_ptr<const SampledVolume>;

struct Ground {
  Vec3i size = Vec3i::Constant(24);
  Vec3 spacing_m = Vec3::Constant(1e-3);
  Mat3 R_WL = Mat3::Identity();
  ExactPlane plane = {};  // through the middle of the volume, between voxels
  double per_voxel = 1;   // how fast the density grows into the object, over the smallest voxel [density/voxel]
  double offset = 0;      // the isovalue [density]

  [[nodiscard]] double voxel_m() const { return spacing_m.minCoeff(); }
  [[nodiscard]] Lattice lattice() const;
  [[nodiscard]] SampledVolumePtr sampled() const;
};

// A volume with the same lattice, whose density at a point is given by its height over the plane [voxel of the
// smallest side] and its place in the world.
[[nodiscard]] SampledVolumePtr sampledFrom(const Ground& ground, double isovalue,
                                           const std::function<double(double height_voxel, const Vec3& p_W)>& density);

// A rigid hand goes from `from_voxel` in front of the plane to `depth_voxel` behind it within 0.3 s, and rests there
// until 0.5 s. K is such that the force is then 2 N.
inline constexpr double kUsualDepth_voxel = 1.5;
[[nodiscard]] RoughRun pressOn(const SampledVolumePtr& volume, const Ground& ground,
                               double depth_voxel = kUsualDepth_voxel, double from_voxel = 3);

// How far an algorithm's surface may be from the plane [m]. Algorithms stop their search within 0.02 voxel along the
// line and 0.02 voxel in density (SurfaceTracker). Rounding to float moves each density by up to 2^-24 of the largest
// one at the cells of the surface (2^-150 for denormals), and eight lerps round as often; so do the gradients, whose
// angle moves the plane's foot by as much for each voxel of depth.
[[nodiscard]] double placeError_m(const Ground& ground, double depth_voxel = kUsualDepth_voxel);

// Presses on the ground and judges that the plane is felt and nothing takes the force away.
[[nodiscard]] ExtremeOutcome feelsGround(const Ground& ground);

}  // namespace palpate
