// SPDX-License-Identifier: Apache-2.0
#include "apps/touch/force_error.hpp"

#include <algorithm>
#include <cmath>

#include "servo/loop/run_figures.hpp"

namespace palpate {
namespace {

constexpr double kOnSurface_voxel = 1e-6;  // how far from the exact surface a point of it may be, by rounding

// The passivity controller's part is no error of the surface's force.
bool isSurfaceForce(const TickRecord& record) {
  return record.in_contact && !record.damped && asVec3(record.force_W).norm() > 0;
}

}  // namespace

double springStiffness(const Scene& scene) {
  double factor = scene.stiffness_density.empty() ? 1 : 0;
  for (const std::vector<double>& row : scene.stiffness_density) factor = std::max(factor, row.at(1));
  return stiffnessOf(scene) * factor;
}

std::optional<TruePoint> exactSurfacePoint(const Phantom& phantom, const Vec3& hip_W) {
  const SurfaceOffset offset = phantom.offset(hip_W);
  const Vec3 point_W = hip_W - offset.distance_m * offset.normal;
  const double off_m = std::abs(phantom.signedDistance_m(point_W));
  if (!(off_m <= kOnSurface_voxel * phantom.lattice().smallestSpacing())) return std::nullopt;
  return TruePoint{point_W, offset.normal, -offset.distance_m};
}

std::optional<double> forceError_N(double stiffness_N_per_m, const TickRecord& record, const TruePoint& truth) {
  const bool should_be = truth.depth_m > 0;
  if (!record.in_contact) return should_be ? std::optional(stiffness_N_per_m * truth.depth_m) : std::nullopt;
  if (!isSurfaceForce(record) || std::isnan(record.depth_m)) return std::nullopt;
  if (truth.normal_W.dot(asVec3(record.normal_W)) < 0) return std::nullopt;
  const Vec3 right_W = should_be ? truth.point_W : asVec3(record.hip_W);
  return stiffness_N_per_m * (surfacePointOf(record) - right_W).norm();
}

bool inSlide(double time_s, const std::vector<PathPhase>& phases) {
  return std::ranges::any_of(phases, [&](const PathPhase& phase) {
    return phase.name == "slide" && time_s >= phase.begin_s && time_s <= phase.end_s;
  });
}

ForceErrors forceErrors(double stiffness_N_per_m, const std::vector<TickRecord>& records,
                        const std::vector<PathPhase>& phases,
                        const std::function<std::optional<TruePoint>(const TickRecord&)>& truthOf) {
  if (std::ranges::any_of(records, [](const TickRecord& r) { return r.in_contact && std::isnan(r.depth_m); }))
    return {};
  ForceErrors slide, all;
  for (const TickRecord& record : records) {
    const bool sliding = inSlide(record.time_s, phases);
    ++all.possible_ticks;
    if (sliding) ++slide.possible_ticks;
    const auto truth = truthOf(record);
    const auto error_N = truth ? forceError_N(stiffness_N_per_m, record, *truth) : std::nullopt;
    if (!error_N) continue;
    for (ForceErrors* sum : {&all, sliding ? &slide : nullptr}) {
      if (sum == nullptr) continue;
      sum->errors_N.push_back(*error_N);
      if (record.in_contact) ++sum->felt_ticks;
    }
  }
  return slide.errors_N.empty() ? all : slide;
}

CountedTicks countedTicks(const std::vector<TickRecord>& records, const std::vector<PathPhase>& phases) {
  CountedTicks counted;
  counted.slide_only = std::ranges::any_of(
      records, [&](const TickRecord& record) { return isSurfaceForce(record) && inSlide(record.time_s, phases); });
  for (const TickRecord& record : records) {
    if (!isSurfaceForce(record) || (counted.slide_only && !inSlide(record.time_s, phases))) continue;
    counted.ticks.push_back(&record);
  }
  return counted;
}

}  // namespace palpate
