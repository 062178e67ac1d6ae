// SPDX-License-Identifier: Apache-2.0
#include "apps/touch/exact_errors.hpp"

#include <cmath>

#include "apps/touch/force_error.hpp"
#include "base/units.hpp"
#include "servo/loop/run_figures.hpp"

namespace palpate {
namespace {

// The exact normal at the surface point nearest to the HIP. In a thin wall this may lie on the side not in touch.
Vec3 exactNormal(const Phantom& phantom, const TickRecord& record) {
  const Vec3 at_hip_W = phantom.normal(Vec3(record.hip_W));
  const Vec3 at_vhip_W = phantom.normal(surfacePointOf(record));
  return at_hip_W.dot(at_vhip_W) < 0 ? at_vhip_W : at_hip_W;
}

}  // namespace

std::optional<ExactErrors> exactErrors(const Phantom& phantom, const std::vector<TickRecord>& records,
                                       const std::vector<PathPhase>& phases, double stiffness_N_per_m) {
  if (!phantom.hasSurface()) return std::nullopt;
  const double voxel_m = phantom.lattice().smallestSpacing();
  const CountedTicks counted = countedTicks(records, phases);
  if (counted.ticks.empty()) return std::nullopt;
  std::vector<double> distance_voxel, angle_deg;
  for (const TickRecord* record : counted.ticks) {
    const Vec3 force_W(record->force_W);
    const Vec3 normal_W = exactNormal(phantom, *record);
    // By atan2, since acos alone is inaccurate for small angles.
    angle_deg.push_back(std::atan2(force_W.cross(normal_W).norm(), force_W.dot(normal_W)) * kDegreesPerRadian);
    if (std::isnan(record->depth_m)) continue;
    distance_voxel.push_back(std::abs(phantom.signedDistance_m(surfacePointOf(*record))) / voxel_m);
  }
  ExactErrors errors;
  errors.slide_only = counted.slide_only;
  errors.ticks = static_cast<std::int64_t>(angle_deg.size());
  const Percentiles angle = percentiles(std::move(angle_deg));
  errors.force_angle_median_deg = angle.p50;
  errors.force_angle_p99_deg = angle.p99;
  if (!distance_voxel.empty()) {
    const Percentiles distance = percentiles(std::move(distance_voxel));
    errors.vhip_median_voxel = distance.p50;
    errors.vhip_p99_voxel = distance.p99;
  }
  const auto truthOf = [&](const TickRecord& record) { return exactSurfacePoint(phantom, asVec3(record.hip_W)); };
  ForceErrors known = forceErrors(stiffness_N_per_m, records, phases, truthOf);
  if (!known.errors_N.empty()) {
    const Percentiles force = percentiles(std::move(known.errors_N));
    errors.force_error_median_N = force.p50;
    errors.force_error_p99_N = force.p99;
  }
  return errors;
}

}  // namespace palpate
