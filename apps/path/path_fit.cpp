// SPDX-License-Identifier: Apache-2.0
#include "apps/path/path_fit.hpp"

#include <algorithm>
#include <cstddef>
#include <vector>

#include "apps/path/pressed_curve.hpp"

namespace palpate {
namespace {

// The length that a finger uses, and its smallest and largest fraction of the object's size.
struct Measure {
  double usual_m, least_share, most_share;
  [[nodiscard]] double of(double size_m) const {
    return std::clamp(usual_m, least_share * size_m, most_share * size_m);
  }
};
constexpr Measure kApproach = {10e-3, 1.0 / 40, 0.5};
constexpr Measure kSlide = {20e-3, 1.0 / 20, 0.7};
constexpr Measure kDepth = {1e-3, 1.0 / 400, 1.0 / 16};

constexpr double kDeepest_m = 4e-3;  // 2 N at the usual stiffness, however large the object is
constexpr double kThinShare = 0.25;  // of a wall that is pressed in
constexpr double kThinnest = 0.1;    // of the points, that may be thinner
constexpr double kMostThicknessSteps = 4096;
constexpr std::size_t kMostThicknessPoints = 1000;
constexpr double kLeastApproachVoxels = 2, kLeastDepthVoxels = 0.05;

}  // namespace

PathFit fitTo(double size_m, double voxel_m) {
  return {.approach_m = std::max(kApproach.of(size_m), kLeastApproachVoxels * voxel_m),
          .slide_m = kSlide.of(size_m),
          .most_depth_m = std::min(std::max(kDepth.of(size_m), kLeastDepthVoxels * voxel_m), kDeepest_m)};
}

double sizeOf(const ObjectPiece& piece, const Lattice& lattice) {
  return (piece.last - piece.first + Vec3i::Ones()).cast<double>().cwiseProduct(lattice.spacing_m).maxCoeff();
}

double thicknessAt(const SurfaceField& field, const SurfaceHit& at, double reach_m) {
  const double step_m =
      std::max(std::min(field.lattice().smallestSpacing() / 8, reach_m / 16), reach_m / kMostThicknessSteps);
  for (double s = step_m; s < reach_m; s += step_m) {
    if (heightAt(field, at.p_W - s * at.normal_W).value_or(1) <= 0) return s - step_m;
  }
  return reach_m;
}

double depthFor(const SurfaceField& field, const SurfaceCurve& curve, const PathFit& fit) {
  const double voxel_m = field.lattice().smallestSpacing();
  std::vector<double> thick_m;
  // Voxels may be very fine along one axis, and then a curve has very many points.
  const std::size_t stride = curve.points.size() / kMostThicknessPoints + 1;
  for (std::size_t i = 0; i < curve.points.size(); i += stride)
    thick_m.push_back(thicknessAt(field, curve.points[i], fit.most_depth_m / kThinShare));
  const auto thin = thick_m.begin() + static_cast<std::ptrdiff_t>(kThinnest * static_cast<double>(thick_m.size()));
  std::nth_element(thick_m.begin(), thin, thick_m.end());
  const double least_m = std::min(kLeastDepthVoxels * voxel_m, fit.most_depth_m);
  double depth_m = std::max(kThinShare * *thin, least_m);
  while (depth_m > least_m && PressedCurve(curve, depth_m, voxel_m).shareOutside(field) > 0)
    depth_m = std::max(depth_m / 2, least_m);
  return depth_m;
}

}  // namespace palpate
