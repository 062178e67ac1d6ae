// SPDX-License-Identifier: Apache-2.0
#include "apps/touch/exact_errors.hpp"

#include <algorithm>
#include <cmath>

#include "base/units.hpp"
#include "servo/loop/quantile.hpp"

namespace palpate {
namespace {

bool inSlide(double time_s, const std::vector<PathPhase>& phases) {
  if (phases.empty()) return true;
  return std::any_of(phases.begin(), phases.end(), [&](const PathPhase& phase) {
    return phase.name == "slide" && time_s >= phase.begin_s && time_s <= phase.end_s;
  });
}

// At the surface point nearest to the HIP; in a thin wall that may lie on the far side, which is not the one in touch.
Vec3 exactNormal(const Phantom& phantom, const TickRecord& record) {
  const Vec3 at_hip_W = phantom.normal(Vec3(record.hip_W));
  const Vec3 at_vhip_W = phantom.normal(Vec3(record.vhip_W));
  return at_hip_W.dot(at_vhip_W) < 0 ? at_vhip_W : at_hip_W;
}

}  // namespace

std::optional<ExactErrors> exactErrors(const Phantom& phantom, const std::vector<TickRecord>& records,
                                       const std::vector<PathPhase>& phases) {
  if (!phantom.hasSurface()) return std::nullopt;
  const double voxel_m = phantom.lattice().smallestSpacing();
  std::vector<double> distance_voxel;
  std::vector<double> angle_deg;
  for (const TickRecord& record : records) {
    const Vec3 force_W(record.force_W);
    if (!record.in_contact || force_W.norm() == 0 || !inSlide(record.time_s, phases)) continue;
    const Vec3 normal_W = exactNormal(phantom, record);
    distance_voxel.push_back(std::abs(phantom.signedDistance_m(Vec3(record.vhip_W))) / voxel_m);
    // By the cross product too: acos alone loses small angles.
    angle_deg.push_back(std::atan2(force_W.cross(normal_W).norm(), force_W.dot(normal_W)) * kDegreesPerRadian);
  }
  if (distance_voxel.empty()) return std::nullopt;
  const Percentiles distance = percentiles(std::move(distance_voxel));
  const Percentiles angle = percentiles(std::move(angle_deg));
  return ExactErrors{distance.p50, distance.p99, angle.p50, angle.p99};
}

}  // namespace palpate
