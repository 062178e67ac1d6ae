// SPDX-License-Identifier: Apache-2.0
#include "apps/extreme/ground.hpp"

#include <algorithm>
#include <cmath>

namespace palpate {

Lattice Ground::lattice() const {
  Lattice lattice;
  lattice.spacing_m = spacing_m;
  lattice.R_WL = R_WL;
  // The plane's point lies between voxels, at another share along each axis, so that no effect of the lattice is left
  // out.
  const Vec3 middle_L = (size.cast<double>() - Vec3(1.4, 0.8, 1.2)) / 2;
  lattice.origin_W = plane.p_W - R_WL * middle_L.cwiseProduct(spacing_m);
  return lattice;
}

SampledVolumePtr Ground::sampled() const {
  return sampledFrom(*this, offset,
                     [this](double height_voxel, const Vec3&) { return offset - per_voxel * height_voxel; });
}

SampledVolumePtr sampledFrom(const Ground& ground, double isovalue,
                             const std::function<double(double height_voxel, const Vec3& p_W)>& density) {
  return std::make_shared<const SampledVolume>(
      volumeOfDensity(ground.size, ground.lattice(), "an extreme case",
                      [&](const Vec3& p_W) { return density(-ground.plane.depth_m(p_W) / ground.voxel_m(), p_W); }),
      isovalue);
}

RoughRun pressOn(const SampledVolumePtr& volume, const Ground& ground, double depth_voxel, double from_voxel) {
  constexpr double kForce_N = 2, kMoves_s = 0.3;
  const double voxel_m = ground.voxel_m();
  const Vec3 start_W = ground.plane.p_W + from_voxel * voxel_m * ground.plane.normal_W;
  const Vec3 end_W = ground.plane.p_W - depth_voxel * voxel_m * ground.plane.normal_W;
  RoughRun run{.volume = volume};
  run.parameters.stiffness_N_per_m = kForce_N / (depth_voxel * voxel_m);
  run.parameters.damping_Ns_per_m = 0;
  run.path_W = [=](double time_s) -> Vec3 {
    return start_W + std::clamp(time_s / kMoves_s, 0.0, 1.0) * (end_W - start_W);
  };
  return run;
}

double placeError_m(const Ground& ground, double depth_voxel) {
  constexpr double kSearch = 0.02 + 0.02, kRoundings = 16, kCells = 4;  // [voxel], [-], [voxel]
  const double largest = std::abs(ground.offset) + kCells * ground.per_voxel;
  const double rounding = std::max(largest * 0x1p-24, 0x1p-150) / ground.per_voxel;  // [voxel]
  return (kSearch + kRoundings * rounding * (1 + depth_voxel)) * ground.spacing_m.maxCoeff();
}

ExtremeOutcome feelsGround(const Ground& ground) {
  const RoughRun run = pressOn(ground.sampled(), ground);
  return Judge(run, play(run)).feels(ground.plane, placeError_m(ground)).raisesNoFadingFault().outcome();
}

}  // namespace palpate
