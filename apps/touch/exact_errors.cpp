// SPDX-License-Identifier: Apache-2.0
#include "apps/touch/exact_errors.hpp"

#include <algorithm>
#include <cmath>

#include "base/units.hpp"
#include "servo/loop/run_figures.hpp"

namespace palpate {
namespace {

bool inSlide(const TickRecord& record, const std::vector<PathPhase>& phases) {
  return std::any_of(phases.begin(), phases.end(), [&](const PathPhase& phase) {
    return phase.name == "slide" && record.time_s >= phase.begin_s && record.time_s <= phase.end_s;
  });
}

// The passivity controller's part is no error of the surface's force.
bool isSurfaceForce(const TickRecord& record) {
  return record.in_contact && !record.damped && Vec3(record.force_W).norm() > 0;
}

// The exact normal at the surface point nearest to the HIP. In a thin wall this may lie on the side not in touch.
Vec3 exactNormal(const Phantom& phantom, const TickRecord& record) {
  const Vec3 at_hip_W = phantom.normal(Vec3(record.hip_W));
  const Vec3 at_vhip_W = phantom.normal(surfacePointOf(record));
  return at_hip_W.dot(at_vhip_W) < 0 ? at_vhip_W : at_hip_W;
}

}  // namespace

std::optional<ExactErrors> exactErrors(const Phantom& phantom, const std::vector<TickRecord>& records,
                                       const std::vector<PathPhase>& phases) {
  if (!phantom.hasSurface()) return std::nullopt;
  const double voxel_m = phantom.lattice().smallestSpacing();
  ExactErrors errors;
  errors.slide_only = std::any_of(records.begin(), records.end(), [&](const TickRecord& record) {
    return isSurfaceForce(record) && inSlide(record, phases);
  });
  std::vector<double> distance_voxel;
  std::vector<double> angle_deg;
  for (const TickRecord& record : records) {
    if (!isSurfaceForce(record) || (errors.slide_only && !inSlide(record, phases))) continue;
    const Vec3 force_W(record.force_W);
    const Vec3 normal_W = exactNormal(phantom, record);
    if (!std::isnan(record.depth_m)) {
      distance_voxel.push_back(std::abs(phantom.signedDistance_m(surfacePointOf(record))) / voxel_m);
    }
    // By atan2, since acos alone is inaccurate for small angles.
    angle_deg.push_back(std::atan2(force_W.cross(normal_W).norm(), force_W.dot(normal_W)) * kDegreesPerRadian);
  }
  if (angle_deg.empty()) return std::nullopt;
  errors.ticks = static_cast<std::int64_t>(angle_deg.size());
  const Percentiles angle = percentiles(std::move(angle_deg));
  errors.force_angle_median_deg = angle.p50;
  errors.force_angle_p99_deg = angle.p99;
  if (!distance_voxel.empty()) {
    const Percentiles distance = percentiles(std::move(distance_voxel));
    errors.vhip_median_voxel = distance.p50;
    errors.vhip_p99_voxel = distance.p99;
  }
  return errors;
}

}  // namespace palpate
