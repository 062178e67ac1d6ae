// SPDX-License-Identifier: Apache-2.0
// Densities of any size that a float can hold, and where the isovalue lies among them.
#include <cmath>

#include <fmt/format.h>

#include "apps/extreme/ground.hpp"

namespace palpate {
namespace value_cases {
namespace {

constexpr const char* kFelt = "the plane is felt as with any other values";

void addScale(ExtremeCases& to, double per_voxel, const char* note) {
  to.push_back({"values", fmt::format("densities that grow by {:g} a voxel{}", per_voxel, note), kFelt,
                [=] { return feelsGround({.per_voxel = per_voxel}); }});
}

void addOffset(ExtremeCases& to, double offset, double per_voxel) {
  to.push_back({"values", fmt::format("isovalue {:g}, densities that grow by {:g} a voxel", offset, per_voxel), kFelt,
                [=] { return feelsGround({.per_voxel = per_voxel, .offset = offset}); }});
}

ExtremeOutcome nothingIsFelt(double density) {
  const Ground ground;
  const RoughRun run = pressOn(sampledFrom(ground, 0, [=](double, const Vec3&) { return density; }), ground);
  return Judge(run, play(run)).feelsNothing().raisesNoFadingFault().outcome();
}

// The servo is handed what no loader lets through: gradients that overflow.
ExtremeOutcome staysWithinLimits(double per_voxel) {
  const Ground ground{.per_voxel = per_voxel};
  const RoughRun run = pressOn(ground.sampled(), ground);
  return Judge(run, play(run)).outcome();
}

ExtremeOutcome isRefused(double per_voxel, double spacing_m) {
  const Ground ground{.spacing_m = Vec3::Constant(spacing_m), .per_voxel = per_voxel};
  return refusedWith("gradients", [&] {
    checkTouchable(volumeOfDensity(ground.size, ground.lattice(), "an extreme case",
                                   [&](const Vec3& p_W) { return per_voxel * ground.plane.depth_m(p_W) / spacing_m; }));
  });
}

}  // namespace
}  // namespace value_cases

void addValueCases(ExtremeCases& to) {
  using namespace value_cases;
  addScale(to, 1e-44, ", denormals of few bits");
  addScale(to, 1e-40, ", denormals");
  for (const double per_voxel : {1e-38, 1e-30, 1e-12, 1e12, 1e30}) addScale(to, per_voxel, "");
  to.push_back({"values", "densities of 1e38", "refused when a volume is to be touched: its gradients fit no float",
                [] { return isRefused(1e37, 1e-3); }});
  to.push_back({"values", "densities of 1e38, in spite of that", "no force beyond the limits",
                [] { return staysWithinLimits(1e37); }});
  to.push_back({"values", "densities of 3e35 in voxels of 1 nm", "refused: its gradients fit no float",
                [] { return isRefused(3e34, 1e-9); }});
  addOffset(to, 1000, 1);
  addOffset(to, 1e6, 1);
  addOffset(to, -1e6, 10);
  addOffset(to, 16777216, 64);
  to.push_back({"values", "every voxel at the isovalue", "nothing is felt: only what is above it is object",
                [] { return nothingIsFelt(0); }});
  to.push_back(
      {"values", "every voxel just below the isovalue", "nothing is felt", [] { return nothingIsFelt(-1e-45); }});
  to.push_back(
      {"values", "a layer of voxels exactly at the isovalue", kFelt, [] {
         // The layer's height is that of the plane: whole steps of a voxel from it.
         const Ground ground{.size = {24, 24, 25}};
         const double shift = std::remainder(ground.lattice().toIndex(Vec3::Zero()).z(), 1.0);
         Ground moved = ground;
         moved.plane.p_W.z() = -shift * ground.voxel_m();
         const SampledVolumePtr volume = std::make_shared<const SampledVolume>(
             volumeOfDensity(ground.size, ground.lattice(), "a layer at the isovalue",
                             [&](const Vec3& p_W) { return std::round(moved.plane.depth_m(p_W) / ground.voxel_m()); }),
             0);
         const RoughRun run = pressOn(volume, moved);
         return Judge(run, play(run)).feels(moved.plane, placeError_m(moved)).raisesNoFadingFault().outcome();
       }});
}

}  // namespace palpate
